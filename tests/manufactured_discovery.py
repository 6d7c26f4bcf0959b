"""A discovery whose numbers are known: an ankle that lacks a one-sided spring of 286 N m/rad above 2 deg."""

from dataclasses import replace

import numpy as np

from gaitdisc.discovery.result import Discovery, Estimate, FoundEffect, GapSize, Runs, Whereabouts
from gaitdisc.recording import Finding
from gaitdisc.saved.provenance import Provenance

NAN = float("nan")
SPRING = FoundEffect(
    "port",
    "ankle_moment",
    "one_sided_spring",
    "-286*(max(0, theta - 0.035))",
    {"stiffness": Estimate(286.0, 279.2, 292.8, "N m/rad"), "engagement": Estimate(0.035, 0.033, 0.037, "rad")},
    0.99,
    812.0,
)
CUBIC = FoundEffect(
    "port", "ankle_moment", "cubic_stiffness", "", {"stiffness": Estimate(4e3, NAN, NAN, "N m/rad^3")}, bic=640.0
)


def manufactured(**changes) -> Discovery:
    """Return it, with other parts where they are asked for."""
    rng = np.random.default_rng(0)
    time = np.arange(400) / 100.0 + np.zeros((2, 1))
    phase = (time / 1.1) % 1.0
    angle = 0.2 * np.sin(2 * np.pi * phase)
    seen = angle + 0.01 * rng.standard_normal(angle.shape)
    gap = 0.05 * np.maximum(0, angle - 0.035)
    shapes = [one[:, :, None] for one in (seen, angle + gap, angle)]
    size = GapSize(0.3, 0.06, 0.05, 0.01, {"theta": (0.054, 0.0105, 0.0087)})
    discovery = Discovery(
        "missing_physics",
        "The simulation lacks a one-sided spring at the ankle_moment port.",
        (Whereabouts("port", "ankle_moment", 0.97, (0.12, 0.55), "theta > 0.035"),),
        (SPRING,),
        (CUBIC,),
        size,
        size,
        ("theta",),
        ("rad",),
        Runs(np.array([3, 3]), time, phase, *shapes, ("a", "b", "c", "d")),
        (Finding("warning", "one trial", "walk.csv", "trial 'a' is the only one", "test on other trials"),),
        Provenance({"title": "Ankle"}, 0, {"ankle.toml": "0" * 64}, {"gaitdisc": "0"}, "", "2026-01-01T00:00:00+00:00"),
    )
    return replace(discovery, **changes)
