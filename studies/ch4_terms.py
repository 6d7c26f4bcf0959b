"""Which terms of a sparse Discrepancy are selected in refits on random halves of the blocks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from ch4_runs import run
from chapter3.sindy import fit_sindy
from further import Number
from real_people import ANGLES

import gaitdisc as gd
from gaitdisc.response.models import fit_linear

REFITS, BLOCKS = 50, 16
OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r")


def discrepancy(nominal: gd.Samples, other: gd.Samples) -> gd.Samples:
    """What a Nominal ridge model misses of another walk, over the right leg and the place in the stride."""
    missed = other.y - fit_linear(nominal).model(other.x)
    names = (*OUTPUTS, *(f"d({name})/dt" for name in OUTPUTS))
    inputs = other.x[:, [other.inputs.index(name) for name in names]]
    turn = 2 * np.pi * other.phi[:, None] / 100
    state, harmonics = inputs / inputs.std(axis=0), [np.cos(turn), np.sin(turn), np.cos(2 * turn), np.sin(2 * turn)]
    x = np.hstack([state, *harmonics, state * harmonics[0], state * harmonics[1]])
    plain = ("hip", "knee", "ankle", "hip rate", "knee rate", "ankle rate")
    words = (*plain, "cos", "sin", "cos2", "sin2", *(f"{n} x {turned}" for turned in ("cos", "sin") for n in plain))
    columns = [ANGLES.index(name) for name in OUTPUTS]
    return gd.Samples(x, missed[:, columns], words, OUTPUTS, other.time, other.phi)


def terms(quick: bool) -> Iterator[Number]:
    """How often each term is selected, for the device and for nothing."""
    (nominal, _), (exo, held) = run("welk007", "natural"), run("welk007", "exotendon")
    half = len(nominal) // 2
    first, second = nominal.rows(slice(0, half)), nominal.rows(slice(half, None))
    for column, before, after, later in (
        ("device", nominal, exo, held),
        ("control", first, second, run("welk007", "natural")[1]),
    ):
        samples, test = discrepancy(before, after), discrepancy(before, later)
        rng = np.random.default_rng(0)
        counts: dict[tuple[str, str], list[float]] = {}
        blocks = np.array_split(np.arange(len(samples)), BLOCKS)
        for _ in range(5 if quick else REFITS):
            some = np.sort(rng.permutation(BLOCKS)[: BLOCKS // 2])
            model = fit_sindy(samples.rows(np.concatenate([blocks[k] for k in some])), 1)
            for name in OUTPUTS:
                for term, value in model.terms(name).items():
                    counts.setdefault((name, term), []).append(value)
        whole = fit_sindy(samples, 1)
        error = 1 - np.mean((whole(test.x) - test.y) ** 2, axis=0) / np.mean(test.y**2, axis=0)
        for name, held_r2 in zip(OUTPUTS, error, strict=True):
            often = [v for (which, _), v in counts.items() if which == name]
            share = np.array([len(v) for v in often]) / (5 if quick else REFITS)
            size = float(np.sqrt(np.mean(test.y[:, OUTPUTS.index(name)] ** 2)))
            yield Number(f"{name}: size of the discrepancy [deg/s2]", column, "", size)
            yield Number(f"{name}: terms of the fit to all", column, "", float(len(whole.terms(name))))
            yield Number(f"{name}: share of it explained, held out [1]", column, "", float(held_r2))
            yield Number(f"{name}: terms selected in 9 of 10 refits", column, "", float((share >= 0.9).sum()))
            yield Number(f"{name}: terms selected at least once", column, "", float(len(share)))
            if column == "device":
                own = sorted(((len(v), t) for (which, t), v in counts.items() if which == name), reverse=True)
                for count, term in own[:4]:
                    yield Number(f"{name}: {term} selected [%]", column, "", 100 * count / (5 if quick else REFITS))
