"""Fields whose answer is known: waves that any one sensor's history tells."""

import numpy as np

from gaitdisc.recording.field import Axis, Field

ROWS, COLUMNS = 6, 12


def travelling_wave(snapshots=400, quantities=1):
    """Two travelling waves of other periods: four modes, told by a few readings of any one point."""
    t = np.arange(snapshots)[:, None, None]
    y, x = np.arange(ROWS)[None, :, None], np.arange(COLUMNS)[None, None, :]
    wave = np.sin(2 * np.pi * (x / 12 - t / 17) + y / 3) + 0.5 * np.cos(2 * np.pi * (y / 6 + t / 29))
    mask = np.ones((ROWS, COLUMNS), bool)
    mask[0, :2] = False
    values = np.stack([(k + 1) * wave[:, mask] for k in range(quantities)], axis=-1)
    axes = (Axis("lat", np.arange(ROWS) * 2.0 - 4, "deg"), Axis("lon", np.arange(COLUMNS) * 2.0, "deg"))
    names, units = ("h", "g")[:quantities], ("m", "m")[:quantities]
    return Field(np.arange(float(snapshots)), values, axes, mask, names, units, "month")
