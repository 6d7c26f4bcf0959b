"""Channels of a recording over time, marked where they are suspect."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gaitdisc.recording import Recording
from gaitdisc.report.wording import label, unit_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_recording(axes: Axes, recording: Recording, names: Sequence[str]) -> None:
    """Draw channels over time; what stands but is not to be trusted is drawn over in grey."""
    chosen = recording.selected(names)
    for column, channel in enumerate(chosen.channels):
        values = chosen.values[:, column]
        axes.plot(chosen.time, values, linewidth=1.0, label=label(channel.name))
        doubtful = np.where(np.asarray(chosen.suspect)[:, column], values, np.nan)
        axes.plot(chosen.time, doubtful, color="#999999", linewidth=2.4, alpha=0.6)
    axes.set_xlabel("time [s]")
    units = list(dict.fromkeys(unit_text(channel.unit) for channel in chosen.channels))
    axes.set_ylabel(f"[{', '.join(units)}]")
    axes.legend(frameon=False)
