"""The answer in one sentence that a clinician or an engineer understands."""

from __future__ import annotations

from dataclasses import replace

from gaitdisc.discovery.inquiry import Inquiry
from gaitdisc.results.discovery import Discovery


def sentence_of(discovery: Discovery, inquiry: Inquiry) -> Discovery:
    """Return the discovery with its sentence.

    Parameters
    ----------
    discovery : Discovery
        Without one.
    inquiry : Inquiry
        What was asked.
    """
    return replace(discovery, sentence=f"{_said(discovery)} {_shown(discovery, inquiry)}".strip())


def _said(discovery: Discovery) -> str:
    if discovery.verdict == "no_gap":
        return "Simulation and data agree to within the noise: nothing is missing that these data could show."
    names = " and ".join(f"{one.name.replace('_', ' ')} at {one.place}" for one in discovery.effects)
    return f"{discovery.verdict.replace('_', ' ').capitalize()}: {names}."


def _shown(discovery: Discovery, inquiry: Inquiry) -> str:
    channel = max(discovery.held_out.channels, key=lambda name: discovery.held_out.channels[name][0])
    before, after, floor = discovery.held_out.channels[channel]
    unit = dict(zip(discovery.channels, discovery.units, strict=True))[channel]
    if discovery.verdict in ("no_gap", "process_noise"):
        return f"Held-out error of {channel}: {before:.3g} {unit} (noise floor {floor:.3g})."
    return f"With it, the held-out error of {channel} falls from {before:.3g} to {after:.3g} {unit} (noise floor {floor:.3g})."
