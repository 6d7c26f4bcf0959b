"""EMG that is hundreds of times weaker or stronger in one trial than in another: one of the two states a wrong unit.

V and mV are a factor of 1000 apart, in every channel. A muscle that rests in one trial, or an electrode that comes off,
changes single channels by as much (young_straight_and_turn has both), so that four of five have to agree.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gaitdisc.recording import Finding, Recording
from gaitdisc.signals.emg_quality import DEAD_SHARE, UNPLUGGED_SHARE, amplifier_range

OVER_STANDING = (0.1, 100.0)  # who walks has more than a tenth of the EMG of standing
OVER_WALKING = (1 / 30, 30.0)
AGREE = 0.8  # share of the channels
FEWEST = 3  # channels that both trials have


def emg_sizes(emg: Recording) -> dict[str, float]:
    """Standard deviation of each channel that has one [V]; without dead and unplugged ones, which have no unit to show.

    The amplifier's range separates them, and only where the recording shows it: a usual range would depend on the unit.
    """
    found = {name: float(np.nanstd(emg[name])) for name in emg.names if np.isfinite(emg[name]).any()}
    limit = amplifier_range(emg)
    least, most = (DEAD_SHARE * limit.volts, UNPLUGGED_SHARE * limit.volts) if limit.shown else (0.0, np.inf)
    return {name: size for name, size in found.items() if size > least and size <= most}


def other_unit_findings(
    own: Mapping[str, float], others: Mapping[str, float], usual: tuple[float, float], trial: str, other: str
) -> list[Finding]:
    """Say that EMG of a trial is so much weaker or stronger than that of another that one states a wrong unit.

    own, others: of `emg_sizes`; the channels in common are compared
    usual (float, float): least and largest ratio that needs no other unit
    """
    common = sorted(set(own) & set(others))
    if len(common) < FEWEST:
        return []
    ratios = np.array([own[name] / others[name] for name in common])
    weak, strong = float(np.mean(ratios < usual[0])), float(np.mean(ratios > usual[1]))
    if max(weak, strong) < AGREE:
        return []
    ratio = float(np.median(ratios))
    how, looks, stated = (
        (f"{1 / ratio:.0f} times weaker", "V", "mV") if ratio < 1 else (f"{ratio:.0f} times stronger", "mV", "V")
    )
    what = f"EMG is {how} than in {other}, the median of {len(common)} channels: its numbers look like {looks} where "
    what += f"{stated} is stated, or those of {other} like {stated} where {looks} is"
    return [Finding("warning", "EMG unit", trial, what, "EMG; state the unit in [channels], or export the file again")]
