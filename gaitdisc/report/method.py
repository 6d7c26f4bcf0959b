"""How the numbers of a run were made, in sentences with the equations."""

from __future__ import annotations

from collections.abc import Mapping

from gaitdisc.report.r2 import held_out_text
from gaitdisc.report.table import flattened
from gaitdisc.results import ResponseRun

_FILTER_WORDS = ("filter", "cutoff", "low_pass", "high_pass", "lowpass", "highpass", "order", "envelope", "band")


def method_sentences(run: ResponseRun) -> list[str]:
    """State, where angles come from markers, models, discrepancy, judgement, filters, a sentence each."""
    held_out = held_out_text(run)
    return [
        *_markers_sentence(run),
        "The state X holds joint angles and, where there are any, EMG envelopes (Eq. 4.1); each model sees X, its "
        "first derivative and percent stride φ, and predicts second derivatives of the outputs.",
        f"The Nominal model f is fitted to the walk without the device effect ({run.nominal}; Eq. 4.2), the Exo model "
        f"Y to the device walk ({run.exo}; Eq. 4.3), which makes it the upper limit of what these inputs can carry.",
        "The Discrepancy model g is fitted to what the Nominal model leaves on the device walk, the measured second "
        "derivative minus f (Eq. 4.4), and the Augmented model is the sum f + g (Eq. 4.5).",
        f"The last {f'{held_out} s' if held_out else 'part'} of each walk is held out before anything is fitted; R² = "
        f"1 − (sum of squared residuals) / (sum of squares about the mean) on these samples, so 1 is all of the "
        f"variance, 0 no better than the mean, and a negative number worse.",
        f"{_filter_sentence(run)} A filter alone makes part of a second derivative predictable "
        f"from the signal itself; the null says how much: R² of band-limited noise that was filtered in the same way.",
    ]


def _markers_sentence(run: ResponseRun) -> list[str]:
    computed = sum(any(finding.kind == "marker set" for finding in walk.findings) for walk in run.walks)
    if not computed:
        return []
    walks = "the one walk" if len(run.walks) == 1 else f"{computed} of {len(run.walks)} walks"
    return [
        f"Joint angles of {walks} are computed from markers, calibrated by the person's static trial, before they are "
        "filtered; which marker set, how far the markers lie from where the static trial has them and what was bridged "
        "stands under “Findings”."
    ]


def _filter_sentence(run: ResponseRun) -> str:
    from gaitdisc.signals.butterworth import effective_cutoff_hz  # brings scipy.signal, which takes a second

    settings = run.provenance.settings
    filters = settings.get("filters")
    if not isinstance(filters, Mapping) or not {"kinematics_hz", "order"} <= set(filters):
        rows = [(k, v) for k, v in flattened(settings) if any(word in k.lower() for word in _FILTER_WORDS)]
        said = ", ".join(f"{key} = {value}" for key, value in rows)
        return f"Filters as the settings state them: {said}." if said else "The settings of the run name no filter."
    order, cutoff = int(filters["order"]), float(filters["kinematics_hz"])
    rates = sorted({walk.rate_hz for walk in run.walks})
    together = " or ".join(f"{effective_cutoff_hz(cutoff, rate, order):.2f} Hz at {rate:g} samples/s" for rate in rates)
    emg = ""
    if {"emg_highpass_hz", "emg_lowpass_hz"} <= set(filters) and _has_emg(run):
        emg = (
            f"; EMG was high-passed at {filters['emg_highpass_hz']:g} Hz, rectified, and low-passed at "
            f"{filters['emg_lowpass_hz']:g} Hz with the same order"
        )
    return (
        f"Angles were low-passed by a Butterworth filter of order {order} a pass, forwards and backwards, so without "
        f"lag, {cutoff:g} Hz at −3 dB of one pass{f' (both passes: {together})' if together else ''}{emg}."
    )


def _has_emg(run: ResponseRun) -> bool:
    return any(channel.quantity == "emg" for walk in run.walks for channel in walk.channels)
