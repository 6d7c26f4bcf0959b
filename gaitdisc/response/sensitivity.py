"""Does the finding rest on a filter's cut-off or on the length of the training part (a limitation the text names)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pandas as pd

from gaitdisc.response.comparison import ALPHA, FEWEST, compare_columns
from gaitdisc.results.variants import VARIANT_TEST_COLUMNS, Variants

ANGLES_HZ = (4.0, 6.0, 8.0, 10.0, 12.0)
EMG_HZ = (4.0, 6.0, 10.0, 15.0, 20.0)
SHARES = (0.25, 0.5)
AS_STUDIED = "as the study has it"


@dataclass(frozen=True)
class Setting:
    """Filters and training length under which a study is fitted again.

    >>> [setting.name for setting in settings_around(6.0, 10.0, emg=False)][:3]
    ['as the study has it', 'angles 4 Hz', 'angles 8 Hz']
    """

    name: str
    angles_hz: float  # Low-pass of the joint angles and of the rectified EMG [Hz]
    emg_hz: float  # Low-pass of the joint angles and of the rectified EMG [Hz]
    share: float = 1.0  # share of the training part that is used, from its beginning; 1 for all of it


def settings_around(angles_hz: float, emg_hz: float, emg: bool = True) -> tuple[Setting, ...]:
    """Settings to try: the study's own, then one thing changed at a time.

    angles_hz, emg_hz: the study's low-pass of the joint angles and of the rectified EMG [Hz]
    """
    angles = [Setting(f"angles {hz:g} Hz", hz, emg_hz) for hz in ANGLES_HZ if hz != angles_hz]
    envelopes = [Setting(f"EMG {hz:g} Hz", angles_hz, hz) for hz in EMG_HZ if emg and hz != emg_hz]
    lengths = [Setting(f"{share:.0%} of the training part", angles_hz, emg_hz, share) for share in SHARES]
    return (Setting(AS_STUDIED, angles_hz, emg_hz), *angles, *envelopes, *lengths)


def compare_settings(people: Sequence[Variants], alpha: float = ALPHA) -> pd.DataFrame:
    """Test Nominal against Augmented under every setting, over participants.

    R2 under two settings are not of the same thing, for the filter makes what is to be predicted as well; the order of
    the models under each setting can be compared, and how far each lies above the null of its filters.

    people: of the question `sensitivity`; fewer than six are not tested
    alpha: of each family of tests: the variables under one setting
    returns: columns `VARIANT_TEST_COLUMNS`; model and second are `augmented`, first `nominal`
    """
    if len(people) < FEWEST:
        return pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))
    table = pd.concat([each.table.assign(participant=each.participant) for each in people], ignore_index=True)
    table = table[table["kind"] == "network"]
    parts = []
    for variant, own in table.groupby("variant", sort=False):
        nominal, augmented = (
            own[own["model"] == model]
            .pivot_table(index="participant", columns="variable", values="r2", sort=False, dropna=False)
            .reindex(index=table["participant"].unique(), columns=table["variable"].unique())
            for model in ("nominal", "augmented")
        )
        found = compare_columns(nominal, augmented, alpha)
        parts.append(found.assign(variant=variant, model="augmented", first="nominal", second="augmented"))
    return pd.concat(parts, ignore_index=True)[list(VARIANT_TEST_COLUMNS)]
