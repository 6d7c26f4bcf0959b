"""Where two walks disagree over the stride."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.batch.compare_recordings import compare_files
from gaitdisc.comparison.compare import compare_walks
from gaitdisc.library.walks import Walk, trial_of
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.recording.recording import several
from gaitdisc.results.mismatch import Smallest

if TYPE_CHECKING:
    from gaitdisc.results.mismatch import Mismatch


def compare(
    first: Walk,
    second: Walk,
    channels: Sequence[str] | str = (),
    cutoff_hz: float = 6.0,
    detector: str = "auto",
    smallest_deg: float = 2.0,
    smallest_n_m_per_kg: float = 0.1,
) -> Mismatch:
    """Say where over the stride two walks disagree, how much, and whether that is more than chance.

    Both are filtered alike and cut at the same mark of the stride; a permutation test over strides holds the chance of
    any false region in any channel at 5 %.

    Parameters
    ----------
    first, second : path, Trial, DataFrame or Recording
        A simulated and a measured walk, or two conditions; the gap is second minus first.
    channels : sequence of str, or str
        Only these; by default all that both have.
    cutoff_hz : float
        Low-pass of angles and moments, -3 dB of one pass [Hz].
    detector : str
        What finds initial contact in both: `auto`, `force`, `events`, `markers` or `angles`.
    smallest_deg : float
        Smallest difference of an angle that is reported [deg].
    smallest_n_m_per_kg : float
        Smallest difference of a joint moment that is reported [N m/kg].

    Returns
    -------
    Mismatch
        Curves, the gap with its band, and the regions of the stride where it is more than chance.

    Raises
    ------
    GaitdiscError
        If a file cannot be read, is no walking, or the two have nothing in common.

    References
    ----------
    Nichols and Holmes 2002; Pataky, Vanrenterghem and Robinson 2015.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walks = gd.example_walks(20.0)
    >>> found = gd.compare(walks["exo"], walks["nominal"], ["ankle_angle_r"])
    >>> found.names
    ('ankle_angle_r',)
    """
    smallest = Smallest(smallest_deg, smallest_n_m_per_kg)
    if isinstance(first, Path | str) and isinstance(second, Path | str):
        return compare_files(Path(first), Path(second), several(channels), cutoff_hz, detector, smallest)
    walks = walk_pair(trial_of(first), trial_of(second), cutoff_hz, detector)
    return compare_walks(walks[0], walks[1], several(channels), smallest=smallest)
