"""A small run with known numbers."""

import numpy as np
import pandas as pd
import pytest

from gaitdisc.channel import Channel
from gaitdisc.processing.pooled_cycles import WalkSummary
from gaitdisc.recording import Finding
from gaitdisc.response.participant_response import HeldOut, ParticipantResponse, ResponseRun
from gaitdisc.response.participants_result import FAMILY_COLUMNS, TEST_COLUMNS, PairTests
from gaitdisc.saved.provenance import Provenance, Refusal


@pytest.fixture
def walk() -> WalkSummary:
    curves = np.random.default_rng(1).normal(size=(4, 101, 2))
    curves[2, 50, 0] = np.nan
    strides = pd.DataFrame(
        {
            "side": ["r", "r", "l"],
            "start_s": [0.1, 1.2, 0.6],
            "end_s": [1.2, 2.3, 1.7],
            "kept": [True, False, True],
            "reason": ["", "0.4 s long", ""],
        }
    )
    channels = (Channel("hip_flexion_r", "angle", "deg", "r"), Channel("knee_angle_r", "angle", "deg", "r"))
    finding = Finding("warning", "gap", "walk.mot", "0.1 s missing", "accelerations", "knee_angle_r", ((1.0, 1.1),))
    return WalkSummary("P01", "exo", 60.0, 100.0, "angles", channels, curves, strides, (finding,), {"walk.mot": "ab"})


@pytest.fixture
def response() -> ParticipantResponse:
    rng = np.random.default_rng(2)
    r2 = pd.DataFrame(
        {
            "variable": ["hip_flexion_r", "hip_flexion_r"],
            "model": ["nominal", "exo"],
            "kind": ["network", "null"],
            "walk": ["exo", "exo"],
            "r2": [0.1 + 0.2, np.nan],
            "n": [30, 30],
        }
    )
    fits = pd.DataFrame(
        {
            "model": ["nominal"],
            "kind": ["network"],
            "decay": [0.1],
            "epochs": [30],
            "n_training": [200],
            "n_inner": [30],
        }
    )
    held_out = HeldOut(
        np.arange(30) / 100, np.linspace(0, 99, 30), rng.normal(size=(30, 1)), {"nominal": np.ones((30, 1))}
    )
    residuals = {"nominal": rng.normal(size=(3, 101, 1))}
    return ParticipantResponse("P01", ("a", "phi"), ("hip_flexion_r",), ("deg/s2",), r2, fits, held_out, residuals, 7.5)


@pytest.fixture
def run(walk, response) -> ResponseRun:
    provenance = Provenance({"order": 4}, 0, {"walk.mot": "ab"}, {"numpy": "2"}, "4.2", "2026-01-01T00:00:00+00:00")
    return ResponseRun(
        "a study",
        "natural",
        "exo",
        (Refusal("P02", "exo", "missing"),),
        provenance,
        {"walk.json": (walk,), "response.json": (response,)},
    )


@pytest.fixture
def pair_tests() -> PairTests:
    test = (
        "augmented", "exo", "hip_flexion_r", 11, 0, False, 10.0, 43 / 1024, 1, 0.05, 43 / 1024, True,
        0.1 + 0.2, 0.4, 0.1, 0.1, -float("inf"), float("inf"), -0.7, "",
    )  # fmt: skip
    family = ("pair", "augmented", "exo", "hip_flexion_r", 1, 0.05, 0.05, 43 / 1024, True)
    tables = pd.DataFrame([test], columns=list(TEST_COLUMNS)), pd.DataFrame([family], columns=list(FAMILY_COLUMNS))
    return PairTests(11, 0.05, 0.95, "", *tables)
