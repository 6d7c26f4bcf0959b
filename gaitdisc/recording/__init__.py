"""Recordings: `Recording`, `Trial`, `Strides`, `Samples`, `Field`, `Finding`, frozen and time first.

This room imports the ground (errors, units, channel names, files) alone.
"""

from gaitdisc.recording.recording import Finding, Recording, Source
from gaitdisc.recording.samples import Samples, Scale, Trajectory, fit_scale
from gaitdisc.recording.strides import PERCENT, Cycle, DroppedStride, Strides
from gaitdisc.recording.trial import Event, Surface, Trial

__all__ = [
    "PERCENT",
    "Cycle",
    "DroppedStride",
    "Event",
    "Finding",
    "Recording",
    "Samples",
    "Scale",
    "Source",
    "Strides",
    "Surface",
    "Trajectory",
    "Trial",
    "fit_scale",
]
