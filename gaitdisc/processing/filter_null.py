"""R2 that noise without any gait reaches through a study's own filters: the floor under every R2 of the table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.ingest.study import Filters
from gaitdisc.processing.process import Walk, is_raw, make_envelope
from gaitdisc.recording import Recording
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.strides import interpolate
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.derivatives import derivative
from gaitdisc.statistics.r2 import simulate_null

Differentiated = tuple[Values, Values, Values]
NOISE_S = 30.0
WALKS = 20


def filter_null(
    channels: Sequence[Channel], filters: Filters, kinematics_hz: float, emg_hz: float | None = None
) -> dict[str, float]:
    """R2 of x'' regressed on x and x' in noise that passed through the same filters as each channel.

    kinematics_hz: rate at which angles were measured and everything is differentiated
    emg_hz: rate of the raw EMG; None where the recording holds envelopes, which are low-passed only
    returns: channel name to R2, about 0.5 for every low-pass
    Source: A flat band has m2^2 / (m0 m4) = 5/9; see `gaitdisc.statistics.r2`.

    >>> knee = Channel("knee_angle_r", "angle", "deg", "r")
    >>> round(filter_null([knee], Filters(), 100.0)["knee_angle_r"], 1)
    0.5
    """
    rate_hz = emg_hz or kinematics_hz

    def angles(noise: Values) -> Differentiated:
        smooth = low_pass(_recording(noise, kinematics_hz, "deg"), filters.kinematics_hz, filters.order)
        return _differentiate(smooth.values, kinematics_hz)

    def emg(noise: Values) -> Differentiated:
        smooth = make_envelope(_recording(noise, rate_hz, "V"), filters, emg_hz is not None)
        time = np.arange(round(len(noise) / rate_hz * kinematics_hz)) / kinematics_hz
        return _differentiate(interpolate(smooth.time, smooth.values, time[:-1]), kinematics_hz)

    reached = {"angle": simulate_null(angles, round(NOISE_S * kinematics_hz), WALKS).r2}
    if any(channel.quantity == "emg" for channel in channels):
        reached["emg"] = simulate_null(emg, round(NOISE_S * rate_hz), WALKS).r2
    return {channel.name: reached["emg" if channel.quantity == "emg" else "angle"] for channel in channels}


def make_filter_null(walk: Walk, filters: Filters) -> dict[str, float]:
    """R2 that noise reaches through the filters of one walk at its own rates; whether EMG is raw is seen from it."""
    emg = walk.trial.streams.get("emg")
    emg_hz = emg.rate_hz if emg is not None and is_raw(emg) else None
    return filter_null(walk.state.channels, filters, walk.state.rate_hz, emg_hz)


def _differentiate(values: Values, rate_hz: float) -> Differentiated:
    parts = (values, derivative(values, rate_hz, 1), derivative(values, rate_hz, 2))
    whole = np.isfinite(np.hstack(parts)).all(axis=1)
    x, xdot, xddot = (part[whole] for part in parts)
    return x, xdot, xddot


def _recording(noise: Values, rate_hz: float, unit: str) -> Recording:
    quantity = "emg" if unit == "V" else "angle"
    channels = tuple(Channel(f"noise_{k}", quantity, unit) for k in range(noise.shape[1]))
    return Recording(np.arange(len(noise)) / rate_hz, noise, channels)
