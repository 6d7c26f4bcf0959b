"""Filters and derivatives of recordings, tables and arrays: what comes in comes back in the same form."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError, ShapeError
from gaitdisc.ingest.table import has_times
from gaitdisc.library.walks import PLAIN, Kind, make_recording
from gaitdisc.recording import Recording, Trial
from gaitdisc.recording.arrays import Values, real_array
from gaitdisc.signals.butterworth import KINEMATICS_HZ, high_pass, low_pass
from gaitdisc.signals.derivatives import differentiate_recording
from gaitdisc.signals.emg import ENVELOPE_HZ, HIGHPASS_HZ, envelopes
from gaitdisc.signals.gaps import MAX_SPLINE_S
from gaitdisc.units import rate_unit

if TYPE_CHECKING:
    import pandas as pd

EMG = ("emg", "V")  # quantity and unit
LIKELY = 10  # an array with more channels than so many times its samples lies on its side
Signal = TypeVar("Signal", Recording, "pd.DataFrame", "pd.Series[Any]", "Values")


def lowpass(
    signal: Signal,
    cutoff_hz: float = KINEMATICS_HZ,
    order: int = 4,
    max_gap_s: float = MAX_SPLINE_S,
    rate_hz: float | None = None,
) -> Signal:
    """Remove frequencies above the cut-off, without lag.

    A Butterworth filter runs forwards and backwards. Gaps up to `max_gap_s` are interpolated by a cubic spline and
    marked suspect; longer gaps stay NaN, and the segments between them are filtered separately. The first and last 1.8
    periods of the cut-off in each segment are marked suspect. A heading that passes 180 deg is unwrapped, filtered and
    wrapped again.

    Parameters
    ----------
    signal : Recording, DataFrame, Series or array_like (time,) or (time, channel)
        A DataFrame must have times [s] in a column `time` or in an index of that name; every other column is filtered.
        A Series must have times in its index. A table without times, like an array, requires `rate_hz`.
    cutoff_hz : float
        -3 dB frequency of one pass [Hz]; for 6 Hz (order 4, 100 Hz), both passes together have -3 dB at 5.39 Hz.
    order : int
        Order of one pass; both passes together have twice the roll-off of one.
    max_gap_s : float
        Longest gap that is bridged [s].
    rate_hz : float, optional
        Sampling rate of a signal without times [Hz].

    Returns
    -------
    Recording, DataFrame, Series or ndarray
        In the form of `signal`; segments too short for the filter are NaN.

    Raises
    ------
    SamplingError
        If the cut-off is not between 0 and half the rate, the signal is too short for it, or an array is given without
        `rate_hz`.

    References
    ----------
    Ebers (2023), section 4.2.1. The two passes, the meaning of the cut-off and the treatment of the edges are not
    stated there, but chosen here.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> t = np.arange(500) / 100
    >>> slow, fast = np.sin(2 * np.pi * t), np.sin(2 * np.pi * 30 * t)
    >>> bool(np.abs(gd.lowpass(slow + fast, cutoff_hz=6.0, rate_hz=100.0) - slow)[100:400].max() < 0.01)
    True
    """
    return _in_its_form(signal, rate_hz, lambda recording: low_pass(recording, cutoff_hz, order, max_gap_s))


def highpass(
    signal: Signal,
    cutoff_hz: float = HIGHPASS_HZ,
    order: int = 4,
    max_gap_s: float = MAX_SPLINE_S,
    rate_hz: float | None = None,
) -> Signal:
    """Remove frequencies below the cut-off, without lag, by the method of `lowpass`.

    Parameters
    ----------
    signal : Recording, DataFrame, Series or array_like (time,) or (time, channel)
        Signal in a form that `lowpass` accepts.
    cutoff_hz : float
        -3 dB frequency of one pass [Hz].
    order : int
        Order of one pass.
    max_gap_s : float
        Longest gap that is bridged [s].
    rate_hz : float, optional
        Sampling rate of a signal without times [Hz].

    Returns
    -------
    Recording, DataFrame, Series or ndarray
        In the form of `signal`; segments too short for the filter are NaN.

    Raises
    ------
    SamplingError
        If `lowpass` would refuse the same arguments.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> t = np.arange(2000) / 1000
    >>> slow, fast = np.sin(2 * np.pi * t), np.sin(2 * np.pi * 120 * t)
    >>> bool(np.abs(gd.highpass(slow + fast, cutoff_hz=40.0, rate_hz=1000.0) - fast)[100:1900].max() < 0.01)
    True
    """
    return _in_its_form(signal, rate_hz, lambda recording: high_pass(recording, cutoff_hz, order, max_gap_s))


def envelope(
    emg: Signal,
    highpass_hz: float = HIGHPASS_HZ,
    lowpass_hz: float = ENVELOPE_HZ,
    order: int = 4,
    rate_hz: float | None = None,
) -> Signal:
    """Compute the envelope of raw EMG: high-passed, rectified and low-passed.

    Parameters
    ----------
    emg : Recording, DataFrame, Series or array_like (time,) or (time, channel)
        Raw EMG, as digitised and not rectified; EMG channels only, in a form that `lowpass` accepts.
    highpass_hz, lowpass_hz : float
        -3 dB frequencies of one pass [Hz].
    order : int
        Order of one pass of both filters.
    rate_hz : float, optional
        Sampling rate of a signal without times [Hz].

    Returns
    -------
    Recording, DataFrame, Series or ndarray
        In the form and unit of `emg`. The low-pass can give small negative values after a burst; these are kept.

    Raises
    ------
    SamplingError
        If the rate is not above twice the high-pass frequency, or the signal is already an envelope.
    ChannelError
        If a channel of a Recording is not EMG.

    References
    ----------
    Ebers (2023), section 4.2.1: high-passed at 40 Hz, rectified, low-passed at 10 Hz, "fourth-order Butterworth
    filters". The number of passes is not stated there; here, two passes of order 4 are used, without lag.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> emg = np.sin(2 * np.pi * 120 * np.arange(2000) / 1000)
    >>> round(float(gd.envelope(emg, rate_hz=1000.0)[1000]), 2)  # mean of a rectified sine: 2 / pi
    0.64
    """
    return _in_its_form(emg, rate_hz, lambda recording: envelopes(recording, highpass_hz, lowpass_hz, order), EMG)


def differentiate(signal: Signal, order: int = 1, rate_hz: float | None = None) -> Signal:
    """Differentiate every channel once or twice, by five-point central differences.

    Parameters
    ----------
    signal : Recording, DataFrame, Series or array_like (time,) or (time, channel)
        Signal in a form that `lowpass` accepts; filter it first, because differentiation amplifies noise.
    order : int
        Order of the derivative, 1 or 2.
    rate_hz : float, optional
        Sampling rate of a signal without times [Hz].

    Returns
    -------
    Recording, DataFrame, Series or ndarray
        Derivative in the form of `signal`; units in a Recording, or in a table's `attrs` and labels, are adapted
        (`deg/s`). NaN at the first and last two samples, and within two samples of a missing sample.

    Raises
    ------
    SamplingError
        If the signal is too short, the order is neither 1 nor 2, or an array is given without `rate_hz`.

    References
    ----------
    Fornberg (1988), Math. Comp. 51, 699-706: weights of fourth order on five points.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> t = np.arange(500) / 100
    >>> bool(np.nanmax(np.abs(gd.differentiate(np.sin(t), rate_hz=100.0) - np.cos(t))) < 1e-6)
    True
    """
    made = _in_its_form(signal, rate_hz, lambda recording: differentiate_recording(recording, order))
    if units := getattr(made, "attrs", {}).get("units"):
        rates = {name: unit if name == "time" else rate_unit(unit, order) for name, unit in units.items()}
        names = {name: str(name).replace(f"[{units[name]}]", f"[{rate}]") for name, rate in rates.items()}
        made.attrs["units"] = {names[name]: rate for name, rate in rates.items()}
        made = made.rename(columns=names) if hasattr(made, "columns") else made.rename(names.get(made.name, made.name))
    return made


def _in_its_form(
    signal: Any, rate_hz: float | None, done: Callable[[Recording], Recording], kind: Kind | None = None
) -> Any:
    if hasattr(signal, "to_frame"):  # a column of a DataFrame
        return _in_its_form(signal.to_frame("signal"), rate_hz, done, kind)["signal"].rename(signal.name)
    is_recorded = issubclass(type(signal), Recording | Trial)
    if is_recorded or hasattr(signal, "columns"):
        timed = is_recorded or has_times(signal)
        timed = signal if timed else signal.set_axis(_times(len(signal), rate_hz)).rename_axis("time")
        recording = make_recording(timed, kind)  # of a trial it says which stream to give
        if rate_hz is not None and not abs(_times(2, rate_hz)[1] * recording.rate_hz - 1) < 1e-3:
            raise SamplingError(
                "rate_hz must agree with the times of the signal",
                f"the times give {recording.rate_hz:g} samples per second, but rate_hz is {rate_hz:g}",
                "Omit rate_hz, or correct the times (they are in seconds).",
            )
        made = done(recording)
        if is_recorded:
            return made
        filtered = signal.copy()
        filtered[[label for label in signal.columns if str(label) in made.names]] = made.values  # without the times
        return filtered
    try:
        values = np.asarray(signal) if np.iscomplexobj(signal) else np.asarray(signal, float)
    except (TypeError, ValueError):
        raise ShapeError(
            "the input of a filter must be a Recording, a DataFrame or an array of numbers",
            f"found {type(signal).__name__}",
            "Read a file with gaitdisc.read first.",
        ) from None
    values = real_array(values)
    if values.ndim not in (1, 2) or (values.ndim == 2 and values.shape[1] > LIKELY * len(values)):
        raise ShapeError(
            "an array must have shape (time,) or (time, channel) to be filtered",
            f"found {values.shape}",
            "Transpose it (array.T), or filter one trial at a time.",
        )
    time = _times(len(values), rate_hz)
    columns = values.reshape(len(values), -1)
    labels = [f"column {number + 1}" for number in range(columns.shape[1])]
    channels = tuple(Channel(label, *(kind or PLAIN)) for label in labels)
    made = done(Recording(time, columns, channels))
    return np.array(made.values).reshape(values.shape)


def _times(count: int, rate_hz: float | None) -> Values:
    if rate_hz is None:
        raise SamplingError(
            "to filter an array or a table without times, rate_hz must be given",
            "it is missing",
            "Give the number of samples per second, for example rate_hz=100.",
        )
    if not isinstance(rate_hz, int | float | np.number) or not 0 < rate_hz < np.inf:
        raise SamplingError(
            "a rate must be a number of samples per second above zero", f"rate_hz is {rate_hz!r}", "Write rate_hz=100."
        )
    return np.arange(count) / rate_hz
