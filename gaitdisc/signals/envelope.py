"""EMG envelope: high-passed, rectified, low-passed."""

from __future__ import annotations

import numpy as np

from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.recording import Recording
from gaitdisc.signals.butterworth import highpassed, lowpassed

HIGHPASS_HZ = 40.0
ENVELOPE_HZ = 10.0


def enveloped(
    emg: Recording, highpass_hz: float = HIGHPASS_HZ, lowpass_hz: float = ENVELOPE_HZ, order: int = 4
) -> Recording:
    """EMG envelope of every channel, at the rate of the recording; raw EMG only, as digitised [V]."""
    file = emg.source.file or "the recording"
    for channel in emg.channels:
        if channel.quantity != "emg":
            raise ChannelError(
                "an envelope is made of raw EMG",
                f"{file} gives {channel.name!r}, which is {channel.quantity}",
                "Select the EMG channels, or name the muscle in the study's [channels].",
            )
    if emg.rate_hz <= 2 * highpass_hz:
        raise SamplingError(
            f"an EMG high-pass of {highpass_hz:g} Hz needs a rate above {2 * highpass_hz:g} samples a second",
            f"{file} has {emg.rate_hz:g}",
            "Give the raw EMG at its full rate (1000 Hz is usual); if it is an envelope already, say so in [emg].",
        )
    _check_raw(emg, file)
    fast = highpassed(emg, highpass_hz, order)
    return lowpassed(fast.with_values(np.abs(fast.values)), lowpass_hz, order)


def _check_raw(emg: Recording, file: str) -> None:
    """Refuse what never falls below zero: rectified or an envelope, whose high-pass would be its noise."""
    for column, channel in enumerate(emg.channels):
        x = emg.values[:, column]
        x = x[np.isfinite(x)]
        if len(x) > 100 and x.min() >= 0 and x.std() > 0 and np.median(x) > 0:
            raise SamplingError(
                "an envelope is made of raw EMG, which swings about zero",
                f"{file}, {channel.name}: all {len(x)} samples lie between {x.min():.3g} and {x.max():.3g} "
                f"{channel.unit}, none below zero",
                "It is rectified or an envelope already: say so in [emg], or export the raw signal.",
            )
