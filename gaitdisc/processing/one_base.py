"""Streams of one trial on one time base, low-passed first where that base is slower than they are."""

from __future__ import annotations

from gaitdisc.processing.process import is_raw
from gaitdisc.recording import Recording, Trial
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.emg import enveloped
from gaitdisc.signals.spikes import without_spikes

SHARE_OF_RATE = 0.4  # cut-off of the low-pass before resampling; half the rate is the limit


def on_one_base(trial: Trial, rate_hz: float, keys: tuple[str, ...] | None = None) -> Recording:
    """Bring streams to one time base without folding what is faster into what is slower.

    A stream that is faster than `rate_hz` is low-passed at 0.4 times that rate; raw EMG becomes its envelope (40 Hz
    high-pass, rectified, 10 Hz low-pass), since nothing of the raw signal would be left.

    returns: the span that all streams cover; filter edges and bridged gaps are marked suspect

    >>> from gaitdisc.cohort.cohort import the_twelve, walks_of
    >>> on_one_base(walks_of(the_twelve()[0], 5.0).trials["nominal"], 100.0).rate_hz
    100.0
    """
    chosen = {key: trial.stream(key) for key in (keys or tuple(trial.streams))}
    ready = {key: _slow_enough(key, recording, rate_hz) for key, recording in chosen.items()}
    return Trial(trial.name, ready, trial.events, (), trial.subject, trial.condition).on_one_base(rate_hz)


def _slow_enough(key: str, recording: Recording, rate_hz: float) -> Recording:
    if recording.rate_hz <= rate_hz * (1 + 1e-6):
        return recording
    if key == "emg" and is_raw(recording):
        return enveloped(recording)
    return lowpassed(without_spikes(recording), SHARE_OF_RATE * rate_hz)
