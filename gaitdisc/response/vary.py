"""Models with one thing changed at a time: inputs left away (section 6.2.2), filters, less data (section 4.2.4)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pandas as pd

from gaitdisc.channel import find_side
from gaitdisc.errors import SamplingError, TrainingError
from gaitdisc.model import Model
from gaitdisc.processing.samples import PHASE
from gaitdisc.recording import Samples, Trajectory
from gaitdisc.response.fit_response import (
    ResponseSettings,
    fit_linear,
    fit_network,
    fit_response,
    pick_held_out,
    report_share,
    split_held_out,
    training_samples,
)
from gaitdisc.response.over_participants import FEWEST, by_participant, compare_columns
from gaitdisc.response.participant_response import QUANTITY_COLUMNS, DataQuantity, ParticipantResponse
from gaitdisc.response.variants import ALL, VARIANT_COLUMNS, VARIANT_TEST_COLUMNS, Variants
from gaitdisc.statistics.r2 import r2

MODELS = ("augmented", "exo")
LENGTHS_S = (1.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0)
ANGLES_HZ = (4.0, 6.0, 8.0, 10.0, 12.0)
EMG_HZ = (4.0, 6.0, 10.0, 15.0, 20.0)
SHARES = (0.25, 0.5)
AS_STUDIED = "as in the study"


def input_families(inputs: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Families of inputs that are left away, one at a time.

    returns: name of the family -> its inputs: a kind of measurement; one joint or muscle, both sides, with its
        velocities. Families that would leave nothing, and those equal to an earlier one, are not among them

    >>> input_families(("knee_angle_r", "emg_sol_r", "emg_gas_r", "d(emg_sol_r)/dt", "phi"))["emg_sol"]
    ('emg_sol_r', 'd(emg_sol_r)/dt')
    """
    channels = {name: name for name in inputs if name != PHASE}
    fast = {name for name in channels if name.startswith("d(")}
    channels |= {name: name.removeprefix("d(").removesuffix(")/dt") for name in fast}
    emg = {name for name in channels if channels[name].startswith("emg_")}
    angles = set(channels) - emg
    groups = {
        "percent stride": {PHASE} & set(inputs),
        "angles and their velocities": angles,
        "EMG and its velocities": emg,
        "angles": angles - fast,
        "angle velocities": angles & fast,
        "EMG": emg - fast,
        "EMG velocities": emg & fast,
    }
    for name, channel in channels.items():
        sideless = channel.removesuffix(f"_{find_side(channel)}") if find_side(channel) else channel
        groups.setdefault(sideless, set()).add(name)
    families: dict[str, tuple[str, ...]] = {}
    for family, members in groups.items():
        chosen = tuple(name for name in inputs if name in members)
        if chosen and len(chosen) < len(inputs) and chosen not in families.values():
            families[family] = chosen
    return families


def fit_without(
    nominal: Trajectory, exo: Trajectory, settings: ResponseSettings, progress: Callable[[float], None] | None = None
) -> pd.DataFrame:
    """Fit Discrepancy and Exo without one family of inputs at a time, and score them on held-out device walking.

    The Nominal model keeps all of its inputs, so that what Augmented loses is what the Discrepancy model lost.

    returns: columns `VARIANT_COLUMNS`; variant is `ALL` or the name of a family
    Source: Ebers 2023, section 6.2.2: which modalities are needed. A family's fall of R2 says what the other
        inputs cannot replace, no more: joint angles and EMG of one walk go together, so that a family whose absence
        costs nothing may carry the response as well as those that stand in for it.
    """
    progress = progress or (lambda _: None)
    training = training_samples(nominal, exo, settings)
    held = pick_held_out(split_held_out(exo, settings)[1], settings)
    families = {ALL: (), **input_families(held.inputs)}
    kinds: dict[str, Callable[[Samples], Model]] = {
        "network": lambda samples: fit_network(samples, settings.training).model,
        "ridge": lambda samples: fit_linear(samples, settings.harmonics).model,
    }
    known = {kind: fit(training[0]) for kind, fit in kinds.items()}
    rows = []
    for number, (family, left_away) in enumerate(families.items()):
        fewer, scored = _without(training[1], left_away), _without(held, left_away)
        for kind, fit in kinds.items():
            missed = fewer.with_outputs(training[1].y - known[kind](training[1].x))
            predicted = {"augmented": known[kind](held.x) + fit(missed)(scored.x), "exo": fit(fewer)(scored.x)}
            for model, values in predicted.items():
                scores = zip(settings.outputs, r2(held.y, values), strict=True)
                rows += [(family, variable, model, kind, value, len(held)) for variable, value in scores]
        progress((number + 1) / len(families))
    return pd.DataFrame(rows, columns=pd.Index(VARIANT_COLUMNS))


def compare_variants(people: Sequence[Variants], question: str) -> pd.DataFrame:
    """Test the networks' R2 under every variant, over six participants or more.

    question: of `modalities` R2 without a family of inputs against R2 with all: a negative shift (second `without`) is
        a fall. Of `sensitivity` Nominal against Augmented under every setting: R2 under two settings are not of the
        same thing, for the filter makes what is predicted, too
    returns: corrected over one variant's and model's variables
    """
    if len(people) < FEWEST:
        return pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))
    table = pd.concat([person.table.assign(participant=person.participant) for person in people], ignore_index=True)
    table = table[table["kind"] == "network"]
    names = list(table["variant"].unique())
    if question == "modalities":
        pairs = [((ALL, model), (name, model), (ALL, "without")) for model in MODELS for name in names if name != ALL]
    else:
        pairs = [((name, "nominal"), (name, "augmented"), ("nominal", "augmented")) for name in names]
    order = {"index": table["participant"].unique(), "columns": table["variable"].unique()}
    wide = {key: by_participant(rows).reindex(**order) for key, rows in table.groupby(["variant", "model"], sort=False)}
    tests = [
        compare_columns(wide[before], wide[after]).assign(variant=after[0], model=after[1], first=first, second=second)
        for before, after, (first, second) in pairs
    ]
    return pd.concat(tests, ignore_index=True)[list(VARIANT_TEST_COLUMNS)]


def _without(samples: Samples, left_away: Sequence[str]) -> Samples:
    columns = [column for column, name in enumerate(samples.inputs) if name not in left_away]
    return replace(samples, x=samples.x[:, columns], inputs=tuple(samples.inputs[column] for column in columns))


@dataclass(frozen=True)
class Setting:
    """Filters and training length under which a study is fitted again.

    >>> [setting.name for setting in settings_around(6.0, 10.0, emg=False)][:3]
    ['as in the study', 'angles 4 Hz', 'angles 8 Hz']
    """

    name: str
    angles_hz: float  # low-pass of the joint angles [Hz]
    emg_hz: float  # low-pass of the rectified EMG [Hz]
    share: float = 1.0  # share of the training part that is used, from its beginning; 1 for all of it


def settings_around(angles_hz: float, emg_hz: float, emg: bool = True) -> tuple[Setting, ...]:
    """Settings to try: the study's low-passes of angles and rectified EMG [Hz], then one changed at a time."""
    angles = [Setting(f"angles {hz:g} Hz", hz, emg_hz) for hz in ANGLES_HZ if hz != angles_hz]
    envelopes = [Setting(f"EMG {hz:g} Hz", angles_hz, hz) for hz in EMG_HZ if emg and hz != emg_hz]
    lengths = [Setting(f"{100 * share:.0f} % of the training part", angles_hz, emg_hz, share) for share in SHARES]
    return (Setting(AS_STUDIED, angles_hz, emg_hz), *angles, *envelopes, *lengths)


def fit_data_quantity(
    nominal: Trajectory,
    exo: Trajectory,
    settings: ResponseSettings,
    lengths_s: Sequence[float] = LENGTHS_S,
    part: str = "first",
    progress: Callable[[float], None] | None = None,
    whole: ParticipantResponse | None = None,
) -> DataQuantity:
    """Fit Nominal, Exo and Discrepancy to parts of the training part, and to all of it, and score each alike.

    lengths_s: lengths of the training part [s]; its whole length is always added
    part: `first` takes the beginning of the training part, from its first usable sample on, `last` its end, next to
        what is held out. The text does not say which; the two differ where gait drifts
    whole: what the whole training part gave with the same settings; it is then not fitted again
    Source: Ebers 2023, section 4.2.4 and Fig. 4.4.
    """
    if part not in ("first", "last"):
        raise SamplingError(
            "the training part must be taken from its first or last seconds", f"found {part!r}", "Write first or last."
        )
    progress = progress or (lambda _: None)
    whole_s = min(_training_s(walk, settings) for walk in (nominal, exo))
    wanted = sorted({length for length in lengths_s if length < whole_s})
    too_long = sorted({length for length in lengths_s if length >= whole_s})
    left_away = dict.fromkeys(too_long, f"the training part is {whole_s:.1f} s long")
    fitted: dict[float, ParticipantResponse] = {}
    for number, length in enumerate(wanted if whole else [*wanted, whole_s]):
        less = [shorten_walk(walk, settings, length, part) for walk in (nominal, exo)]
        report = partial(report_share, progress, number, len(wanted) + 1)
        try:
            fitted[length] = fit_response(less[0], less[1], settings, progress=report)
        except TrainingError as error:
            left_away[length] = str(error)
    if whole:
        fitted[whole_s] = whole
    progress(1.0)
    tables = [pd.DataFrame(columns=pd.Index(QUANTITY_COLUMNS))] if not fitted else []
    for length, response in fitted.items():
        fits, scores = response.fits, response.r2
        used = int(fits[(fits["model"] == "exo") & (fits["kind"] == "network")]["n_training"].iloc[0])
        scores = scores[scores["kind"] != "null"]  # the filters' null has no length
        tables.append(scores.assign(length_s=length, n_training=used)[list(QUANTITY_COLUMNS)])
    return DataQuantity(exo.subject or nominal.subject, part, pd.concat(tables, ignore_index=True), left_away)


def first_share(walk: Trajectory, settings: ResponseSettings, share: float) -> Trajectory:
    """Walk of whose training part the first so much is used."""
    return walk if share == 1 else shorten_walk(walk, settings, share * _training_s(walk, settings), "first")


def shorten_walk(walk: Trajectory, settings: ResponseSettings, length_s: float, part: str) -> Trajectory:
    """Walk whose training part keeps `length_s` [s] usable; the held-out part is untouched."""
    training, _ = split_held_out(walk, settings)
    count, keep = len(training.time), round(length_s * walk.rate_hz)
    good = np.flatnonzero(np.isfinite(training.phi) & training.usable.all(axis=1))
    if not len(good):
        return walk
    usable = walk.usable.copy()
    if part == "first":  # counted from the first sample that can be used: a filter's edge teaches nothing
        usable[good[0] + keep : count] = False
    else:
        usable[: max(0, good[-1] + 1 - keep)] = False
    return replace(walk, usable=usable)


def _training_s(walk: Trajectory, settings: ResponseSettings) -> float:
    training = split_held_out(walk, settings)[0]
    return len(training.time) / training.rate_hz
