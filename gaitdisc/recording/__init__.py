"""Recordings: `Recording`, `Trial`, `Strides`, `Samples`, `Field`, `Finding`, frozen and time first.

This room imports the ground (errors, units, channel names, files) alone.
"""

# ruff: noqa: F401  # what others import from here
from gaitdisc.recording.recording import Finding, Recording, Source
from gaitdisc.recording.samples import Samples, Scale, Trajectory, fit_scale
from gaitdisc.recording.strides import PERCENT, Cycle, DroppedStride, Strides
from gaitdisc.recording.trial import Event, Surface, Trial
