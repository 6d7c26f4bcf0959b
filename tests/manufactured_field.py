"""Fields whose answer is known: waves that any one sensor's history tells."""

import numpy as np

from gaitdisc.recording import Axis, Field


def travelling_wave(snapshots=400, rows=6, columns=12, noise=0.0, quantities=1):
    """Two travelling waves of other periods: four modes, told by a few readings of any one point."""
    t = np.arange(snapshots)[:, None, None]
    y, x = np.arange(rows)[None, :, None], np.arange(columns)[None, None, :]
    wave = np.sin(2 * np.pi * (x / 12 - t / 17) + y / 3) + 0.5 * np.cos(2 * np.pi * (y / 6 + t / 29))
    wave = wave + noise * np.random.default_rng(0).normal(size=wave.shape)
    mask = np.ones((rows, columns), bool)
    mask[0, :2] = False
    values = np.stack([(k + 1) * wave[:, mask] for k in range(quantities)], axis=-1)
    axes = (Axis("lat", np.arange(rows) * 2.0 - 4, "deg"), Axis("lon", np.arange(columns) * 2.0, "deg"))
    names, units = ("h", "g")[:quantities], ("m", "m")[:quantities]
    return Field(np.arange(float(snapshots)), values, axes, mask, names, units, "month")
