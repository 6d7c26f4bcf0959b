"""Manufactured runs: residuals and R2 of known shape, the same at every call."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.processing.pooled_cycles import WalkSummary
from gaitdisc.recording import PERCENT, Finding
from gaitdisc.response.over_participants import compare_models, compare_participants
from gaitdisc.response.participant_response import HeldOut, ParticipantResponse, ResponseRun
from gaitdisc.saved.provenance import Provenance, Refusal

RATE_HZ = 100.0
STRIDE_S = 1.07
ANGLES = tuple(
    f"{joint}_{side}"
    for joint in ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
    for side in ("r", "l")
)
MUSCLES = tuple(f"emg_{muscle}_{side}" for muscle in ("sol", "gas", "ta", "vas", "rf", "ham", "gmed") for side in "rl")
SWING = {"hip": (8.0, 20.0), "knee": (30.0, 22.0), "ankle": (-2.0, 11.0), "emg": (0.08, 0.05)}


def _bump(percent, centre, width=9.0):
    away = (percent - centre + 50.0) % 100.0 - 50.0
    return np.exp(-0.5 * (away / width) ** 2)


def _cycle(percent, seed):
    """Second derivative over the stride, unit variance."""
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * percent[..., None] / 100.0 * np.arange(1, 6)
    wave = (np.sin(angle + rng.uniform(0, 6, 5)) * rng.uniform(0.4, 1.0, 5)).sum(-1)
    return wave / 0.9


def make_walk(subject, condition, *, seconds=60.0, channels=ANGLES, seed=0, shift=0.0, findings=()):
    rng = np.random.default_rng(seed)
    rows = []
    for side, first in (("r", 0.3), ("l", 0.3 + STRIDE_S / 2)):
        start = first
        while start + STRIDE_S * 1.2 < seconds:
            length = STRIDE_S * (1 + 0.015 * rng.standard_normal())
            reason = ""
            if rng.random() < 0.04:
                length *= 1.5
                reason = f"lasts {length:.2f} s, the median is {STRIDE_S:.2f} s"
            elif rng.random() < 0.03:
                reason = f"0.{rng.integers(12, 40)} s of ankle_angle_{side} are missing"
            rows.append((side, round(start, 3), round(start + length, 3), not reason, reason))
            start += length
    strides = pd.DataFrame(rows, columns=["side", "start_s", "end_s", "kept", "reason"])
    kept = int((strides["kept"] & (strides["side"] == "r")).sum())
    curves = np.empty((kept, 101, len(channels)))
    known = []
    for column, name in enumerate(channels):
        known.append(vocabulary().named(name) or Channel(name, "signal", "1"))
        middle, reach = SWING.get(name.split("_")[0], (0.0, 5.0))
        phase = (PERCENT + (50.0 if name.endswith("_l") else 0.0)) % 100
        base = middle + reach * (0.5 * _cycle(phase, len(name)) + shift * _bump(phase, 40))
        noise = 0.15 * reach * rng.standard_normal((kept, 1)) + 0.03 * reach * rng.standard_normal((kept, 101))
        curves[:, :, column] = base + noise
    return WalkSummary(
        subject, condition, seconds, RATE_HZ, "angles", tuple(known), curves, strides, tuple(findings),
        {f"{subject}_{condition}.mot": "0" * 64},
    )  # fmt: skip


def make_response(subject, *, outputs=ANGLES, held_out_s=7.5, seed=0, gain=0.9, ridge=0.1, missing=0.45):
    """Nominal leaves `missing` times a bump at 30 %, Augmented 1 - `gain` of it; ridge adds noise of `ridge`."""
    rng = np.random.default_rng([seed, 7])
    count = round(held_out_s * RATE_HZ) - 1
    time = 52.5 + np.arange(count) / RATE_HZ
    phi = (100.0 * (time - 52.6) / STRIDE_S) % 100.0
    scale = np.array([0.4 if name.startswith("emg") else 900.0 + 250.0 * (i % 5) for i, name in enumerate(outputs)])
    measured = np.stack([_cycle(phi, [i, 3]) for i in range(len(outputs))], 1)
    bump = np.stack([_bump(phi, 30 + 4 * (i % 3)) for i in range(len(outputs))], 1)
    left = {"nominal": missing, "augmented": missing * (1 - gain), "exo": 0.02}
    noise = 0.5 * _smooth(rng.standard_normal((1, *measured.shape)))[0]
    measured = measured + bump * missing * 2 + noise
    extra = {model: 0.06 * rng.standard_normal(measured.shape) for model in left}
    predicted = {m: measured - noise - 2.4 * k * bump + extra[m] for m, k in left.items()}
    table = []
    spread = ((measured - measured.mean(0)) ** 2).sum(0)

    def add(model, kind, walk, values):
        table.extend((v, model, kind, walk, float(x), count) for v, x in zip(outputs, values, strict=True))

    for model, values in predicted.items():
        r2 = 1 - ((measured - values) ** 2).sum(0) / spread
        add(model, "network", "exo", r2)
        add(model, "ridge", "exo", r2 - ridge)
        add(model, "linear", "exo", r2 - 2 * ridge)
    add("nominal", "network", "nominal", np.full(len(outputs), 0.95) - 0.01 * rng.random(len(outputs)))
    add("nominal", "ridge", "nominal", np.full(len(outputs), 0.93))
    add("nominal", "null", "exo", np.full(len(outputs), 0.51))
    strides = int(held_out_s // STRIDE_S)
    curves = np.stack([_bump(PERCENT, 30 + 4 * (i % 3)) for i in range(len(outputs))], 1)
    residuals = {
        model: scale * (2.4 * k * curves + 0.16 * _smooth(rng.standard_normal((strides, 101, len(outputs)))))
        for model, k in left.items()
    }
    fits = pd.DataFrame(
        [
            (m, k, 0.1 if k == "network" else 0.01, 40 if k == "network" else 0, 5214, 782)
            for m in ("nominal", "exo", "discrepancy")
            for k in ("network", "ridge")
        ],
        columns=["model", "kind", "decay", "epochs", "n_training", "n_inner"],
    )
    return ParticipantResponse(
        subject,
        (*outputs, *(f"{name}'" for name in outputs), "sin phi", "cos phi"),
        tuple(outputs),
        tuple("V/s2" if name.startswith("emg") else "deg/s2" for name in outputs),
        pd.DataFrame(table, columns=["variable", "model", "kind", "walk", "r2", "n"]),
        fits,
        HeldOut(time, phi, scale * measured, {m: scale * v for m, v in predicted.items()}),
        residuals,
        held_out_s,
    )


def _smooth(noise):
    kernel = np.hanning(11) / np.hanning(11).sum() * 2
    return np.apply_along_axis(lambda v: np.convolve(v, kernel, "same"), 1, noise)


def make_run(
    participants=1, outputs=ANGLES, refusals=(), *, title="Ankle spring, a manufactured study", seconds=60.0, **response
):
    warning = Finding(
        "warning", "gap", "P01_spring.mot", "0.12 s missing", "accelerations within 0.15 s", "knee_angle_r",
        ((12.31, 12.43), (40.1, 40.22)),
    )  # fmt: skip
    note = Finding("note", "units", "P01_natural.mot", "angles in degrees", "nothing")
    walks, responses = [], []
    for i in range(participants):
        name = f"P{i + 1:02d}"
        walks.append(make_walk(name, "natural", seed=2 * i, channels=outputs, findings=(note,), seconds=seconds))
        found = (note, warning) if i % 3 == 0 else ()
        walks.append(
            make_walk(name, "spring", seed=2 * i + 1, channels=outputs, shift=0.4, findings=found, seconds=seconds)
        )
        responses.append(make_response(name, outputs=outputs, seed=i, **response))
    provenance = Provenance(
        {
            "filters": {
                "kinematics_hz": 6.0,
                "emg_highpass_hz": 40.0,
                "emg_lowpass_hz": 10.0,
                "order": 4,
                "gap_s": 0.1,
            },
            "held_out": {"share": 0.125, "seconds": None},
        },
        11,
        {file: digest for walk in walks for file, digest in walk.files.items()},
        {"gaitdisc": "0.1.0", "python": "3.11.7", "numpy": "2.4.6"},
        "4.2",
        "2026-01-01T00:00:00+00:00",
    )
    return ResponseRun(
        title,
        "natural",
        "spring",
        tuple(refusals),
        provenance,
        {"walk.json": tuple(walks), "response.json": tuple(responses)},
    )


REFUSAL = Refusal(
    "P13",
    "spring",
    "strides need initial contacts of both feet; P13_spring.mot has 3 in 60.0 s. Name the forces in [channels].",
)


@pytest.fixture(scope="session")
def run_maker():
    return make_run


@pytest.fixture(scope="session")
def response_maker():
    return make_response


@pytest.fixture(scope="session")
def run():
    return make_run(outputs=("hip_flexion_r", "ankle_angle_l"), refusals=(REFUSAL,))


@pytest.fixture(scope="session")
def refusal():
    return REFUSAL


def make_tested(participants=11, outputs=("hip_flexion_r", "ankle_angle_l", "emg_sol_r"), over=False):
    """Augmented equals Exo but for noise in all variables, but in the second it is .02 lower in everybody."""
    responses = []
    rng = np.random.default_rng(4)
    for i in range(participants):
        response = make_response(f"P{i + 1:02d}", outputs=outputs, seed=i)
        table = response.r2
        for column, variable in enumerate(outputs):
            exo = 0.95 - 0.1 * column + 0.01 * rng.standard_normal()
            augmented = exo - (0.02 if column == 1 else 0.0) + 0.001 * rng.standard_normal()
            for model, value in (("nominal", exo - 0.1), ("augmented", augmented), ("exo", exo)):
                chosen = (table["kind"] == "network") & (table["walk"] == "exo") & (table["model"] == model)
                table.loc[chosen & (table["variable"] == variable), "r2"] = value
        responses.append(response)
    run = make_run(0, outputs=outputs)
    units = {"response.json": tuple(responses), "tests.json": (compare_models(responses),)}
    units |= {"over.json": (compare_participants(responses),)} if over else {}
    return replace(run, units={**run.units, **units})


@pytest.fixture(scope="session")
def tested_maker():
    return make_tested


@pytest.fixture(scope="session")
def tested():
    return make_tested(over=True)


@pytest.fixture(scope="session")
def reconstruction():
    """One sensor `a`, one state `late`, five strides, two models."""
    from gaitdisc.reconstruction.reconstruction import MEASURES, Reconstruction

    whose = pd.DataFrame({"participant": "P01", "model": ["linear", "delay ridge"]})
    numbers = dict.fromkeys(MEASURES, 0.5) | {"rmse_deg": [4.0, 1.25], "check_loss": [0.9, 0.1]}
    errors = {
        "state": "late",
        "unit": "deg",
        "rmse": [4.0, 1.25],
        "low": 1.0,
        "high": 5.0,
        "relative_l2": 0.1,
        "r2": 0.9,
    }
    percent = np.tile(np.arange(1.0, 100.0, 2.0), 2)
    shown = {"measured": np.sin(percent / 16), "measured_sd": 0.1, "reconstructed": np.sin(percent / 15), "rmse": 0.2}
    model = np.repeat(["linear", "delay ridge"], 50)
    curves = pd.DataFrame({"participant": "P01", "model": model, "state": "late", "percent": percent, **shown})
    return Reconstruction(
        "pair",
        (Channel("a", "angle", "deg"),),
        (Channel("late", "angle", "deg"),),
        "temporal: first 70 % fitted",
        "25 samples of each sensor, 0.04 s apart",
        {"linear": "a line", "delay ridge": "a line through the history"},
        whose.assign(**errors),
        whose.assign(strides=5, n_fitted=100, **numbers),
        curves,
        (),
        (),
        Provenance({}, 0, {"a.mot": "0" * 64}, {}, "5.3.3", "2026-01-01T00:00:00+00:00"),
    )
