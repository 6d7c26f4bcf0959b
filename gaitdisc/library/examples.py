"""Walks to try things on: two of a simulated person of the embedded cohort."""

from __future__ import annotations

from gaitdisc.cohort.cohort import the_twelve, walks_of
from gaitdisc.recording import Trial


def example_walks(duration_s: float = 20.0) -> dict[str, Trial]:
    """Two walks of one simulated person on a treadmill, as a laboratory would record them.

    Parameters
    ----------
    duration_s : float
        Length of each [s].

    Returns
    -------
    dict of str to Trial
        `nominal`, without a device, and `exo`, with a spring at the ankle; each with joint angles at 100 Hz,
        and with raw EMG and ground forces at 1000 Hz.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> sorted(gd.example_walks(5.0))
    ['exo', 'nominal']
    """
    return walks_of(the_twelve()[0], duration_s).trials
