"""Recordings: `Recording`, `Trial`, `Strides`, `Samples`, `Field`, `Finding`, frozen and time first.

This room imports the ground (errors, units, channel names, files) alone.
"""

from gaitdisc.recording.recording import Finding as Finding
from gaitdisc.recording.recording import Recording as Recording
from gaitdisc.recording.recording import Source as Source
from gaitdisc.recording.samples import Samples as Samples
from gaitdisc.recording.samples import Scale as Scale
from gaitdisc.recording.samples import Trajectory as Trajectory
from gaitdisc.recording.samples import fit_scale as fit_scale
from gaitdisc.recording.strides import PERCENT as PERCENT
from gaitdisc.recording.strides import Cycle as Cycle
from gaitdisc.recording.strides import DroppedStride as DroppedStride
from gaitdisc.recording.strides import Strides as Strides
from gaitdisc.recording.trial import Event as Event
from gaitdisc.recording.trial import Surface as Surface
from gaitdisc.recording.trial import Trial as Trial
