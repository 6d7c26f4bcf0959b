"""Training all networks of chapter 4: ours against the loop a user would write, side by side in one run.

    python benchmarks/train_networks.py [--share 0.1] [--processes 2] [--only ours|loop] [--arithmetic auto|torch]

The study: twelve people, ten lengths of the training part (1 to 210 s at 100 Hz), three networks each (Nominal, Exo,
Discrepancy): 360 networks of 49 inputs, 64 and 64 nodes, 8 outputs. `--share` takes that part of the people, with all
their lengths and models. The walks are made here: Fourier series of a wandering phase with wandering amplitudes and
noise, through the filters of the study, with a device that changes the series; outputs are second derivatives.

The loop: PyTorch, DataLoader, batch 64, Adam at 1e-3, 30 epochs, one network after the other, one thread (two are
slower). Ours: `fit_models` with its defaults, decays and penalties chosen on inner blocks, in processes of one thread.
Before and after each length our side multiplies matrices of 1024 x 1024 in float32, so that its share of the
machine's rate is one of what neighbours left at that time. Starting processes is told apart: it is paid once.
"""

from __future__ import annotations

import argparse
import os
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass

os.environ.setdefault("OMP_NUM_THREADS", "1")

import joblib
import numpy as np
import torch
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt
from torch import nn
from torch.utils.data import DataLoader, TensorDataset

from gaitdisc.networks import trainer
from gaitdisc.networks.threads import pinned_threads
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.recording import Samples
from gaitdisc.response.models import fit_models, fit_network
from gaitdisc.statistics.r2 import r2

PEOPLE, RATE_HZ, WALK_S, HELD_OUT_S = 12, 100.0, 240.0, 30.0
LENGTHS_S = (1, 10, 20, 30, 45, 60, 90, 120, 180, 210)
ANGLES, MUSCLES = 10, 14
ANGLE_HZ, ENVELOPE_HZ = 6.0, 10.0
VARIABLES = {"hip": 0, "knee": 3, "ankle": 4, "HAM": 10, "RF": 11, "VAS": 12, "GAS": 13, "SOL": 14}
MODELS = ("nominal", "augmented", "exo")
FORWARD = 2 * (49 * 64 + 64 * 64 + 64 * 8)  # FLOP of the matrix products for one sample
FORWARD_BACKWARD = 2 * FORWARD + 2 * (64 * 64 + 64 * 8)  # no gradient of the inputs
GOAL_S, GOAL_R2, GOAL_RATE = 60.0, 0.005, 0.45


@dataclass(frozen=True)
class Done:
    """A person and length: R2 (model, variable), seconds by the clock and of the core; ours: matrix work, rates."""

    r2: NDArray[np.float64]
    seconds: float
    core_seconds: float
    flop: float = 0.0
    rates: tuple[tuple[float, float], ...] = ()


def walk(person: int, device: bool) -> Samples:
    """240 s of one person: 24 channels, their rates and percent stride; second derivatives of eight channels."""
    body, trial = np.random.default_rng([77, person]), np.random.default_rng([78, person, device])
    count = int(WALK_S * RATE_HZ)
    phase = np.cumsum((0.93 + 0.05 * body.normal()) * (1 + 0.02 * slow(trial, count, 1, 1.0)[:, 0])) / RATE_HZ
    x = np.empty((count, ANGLES + MUSCLES))
    for column in range(ANGLES + MUSCLES):
        angle = column < ANGLES
        order = np.arange(1, 7 if angle else 10)
        series = body.normal(size=(len(order), 2)) / order[:, None] ** (1.5 if angle else 1.0)
        changed = body.normal(size=series.shape) / order[:, None] ** 1.5
        series = (series + 0.15 * device * changed) * (
            1 + 0.12 * slow(trial, count, series.size, 0.6).reshape(count, -1, 2)
        )
        turn = 2 * np.pi * phase[:, None] * order
        values = np.sum(series[:, :, 0] * np.cos(turn) + series[:, :, 1] * np.sin(turn), axis=1)
        values /= values.std()
        if not angle:
            values = np.exp(values) / np.exp(values).std()  # bursts
        cutoff = ANGLE_HZ if angle else ENVELOPE_HZ
        x[:, column] = low_pass(
            values + (0.05 if angle else 0.35) * slow(trial, count, 1, cutoff)[:, 0], RATE_HZ, cutoff
        )
    rates = np.gradient(x, 1 / RATE_HZ, axis=0)
    y = np.gradient(rates, 1 / RATE_HZ, axis=0)[:, list(VARIABLES.values())]
    phi = 100 * (phase % 1)
    names = [f"channel_{number}" for number in range(x.shape[1])]
    inputs = (*names, *(f"{name}_rate" for name in names), "phi")
    return Samples(np.column_stack([x, rates, phi]), y, inputs, tuple(VARIABLES), np.arange(count) / RATE_HZ, phi)


def slow(random: np.random.Generator, count: int, columns: int, cutoff_hz: float) -> NDArray[np.float64]:
    """Noise below a frequency, standard deviation 1."""
    noise = low_pass(random.normal(size=(count, columns)), RATE_HZ, cutoff_hz)
    return noise / noise.std(axis=0)


def low_pass(values: NDArray[np.float64], rate_hz: float, cutoff_hz: float) -> NDArray[np.float64]:
    """Butterworth of order 4 each way, as the study's."""
    return np.asarray(sosfiltfilt(butter(4, cutoff_hz, fs=rate_hz, output="sos"), values, axis=0))


def parts(walks: tuple[Samples, Samples], length_s: int) -> tuple[Samples, Samples, Samples]:
    """Training parts of the walks without and with device, and held-out device walking."""
    first, held_out = slice(0, int(length_s * RATE_HZ)), slice(int((WALK_S - HELD_OUT_S) * RATE_HZ), None)
    return walks[0].rows(first), walks[1].rows(first), walks[1].rows(held_out)


def ours(nominal: Samples, exo: Samples, held_out: Samples, arithmetic: str) -> Done:
    """Three networks by the package, with the machine's matrix rate before and after."""
    settings = TrainingSettings(arithmetic=arithmetic)
    work: list[float] = []
    counted = _counted(work)
    trainer.descend, plain = counted, trainer.descend
    rates = [matrix_rate()]
    try:
        begun, begun_core = time.perf_counter(), time.process_time()
        models = fit_models(nominal, exo, lambda samples, told: fit_network(samples, settings, told))
        seconds, core_seconds = time.perf_counter() - begun, time.process_time() - begun_core
    finally:
        trainer.descend = plain
    rates.append(matrix_rate())
    on_exo = models.on_exo()
    found = np.stack([r2(held_out.y, on_exo[name](held_out.x)) for name in MODELS])
    return Done(found, seconds, core_seconds, sum(work), tuple(rates))


def _counted(work: list[float]) -> Callable:
    plain = trainer.descend

    def descend(network, part, check, *rest):
        done = plain(network, part, check, *rest)
        work.append(len(done.losses) * (len(part[0]) * FORWARD_BACKWARD + len(check[0]) * FORWARD))
        return done

    return descend


def matrix_rate(products: int = 4) -> tuple[float, float]:
    """Float32 matrix products of one thread, by the clock and by the core's time [FLOP/s]."""
    square = np.ones((1024, 1024), np.float32)
    with pinned_threads(1):
        begun, begun_core = time.perf_counter(), time.process_time()
        for _ in range(products):
            np.matmul(square, square)
        flop = products * 2 * 1024**3
        return flop / (time.perf_counter() - begun), flop / (time.process_time() - begun_core)


class UsersNetwork(nn.Module):
    """The same network as a user would write it."""

    def __init__(self) -> None:
        super().__init__()
        self.first, self.second, self.third = nn.Linear(49, 64), nn.Linear(64, 64), nn.Linear(64, 8)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Scaled outputs."""
        return self.third(torch.exp(-(self.second(torch.sigmoid(self.first(x))) ** 2)))


def users_fit(x: NDArray[np.float64], y: NDArray[np.float64]) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    torch.manual_seed(0)
    x_mean, x_sd, y_mean, y_sd = x.mean(0), x.std(0), y.mean(0), y.std(0)
    scaled = [torch.tensor(v, dtype=torch.float32) for v in ((x - x_mean) / x_sd, (y - y_mean) / y_sd)]
    network, loss = UsersNetwork(), nn.MSELoss()
    adam = torch.optim.Adam(network.parameters(), lr=1e-3)
    batches = DataLoader(TensorDataset(*scaled), batch_size=64, shuffle=True)
    for _ in range(30):
        for x_batch, y_batch in batches:
            adam.zero_grad()
            loss(network(x_batch), y_batch).backward()
            adam.step()

    def predicted(values: NDArray[np.float64]) -> NDArray[np.float64]:
        with torch.no_grad():
            return network(torch.tensor((values - x_mean) / x_sd, dtype=torch.float32)).double().numpy() * y_sd + y_mean

    return predicted


def users_loop(nominal: Samples, exo: Samples, held_out: Samples) -> Done:
    """Three networks by the loop, one after the other."""
    with pinned_threads(1):
        begun, begun_core = time.perf_counter(), time.process_time()
        f, y = users_fit(nominal.x, nominal.y), users_fit(exo.x, exo.y)
        g = users_fit(exo.x, exo.y - f(exo.x))
        seconds, core_seconds = time.perf_counter() - begun, time.process_time() - begun_core
    x = held_out.x
    predictions = {"nominal": f(x), "augmented": f(x) + g(x), "exo": y(x)}
    return Done(np.stack([r2(held_out.y, predictions[name]) for name in MODELS]), seconds, core_seconds)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("--share", type=float, default=0.1, help="of the people, at least one")
    arguments.add_argument("--processes", type=int, default=2)
    arguments.add_argument("--only", choices=("ours", "loop"))
    arguments.add_argument("--arithmetic", choices=("auto", "torch"), default="auto")
    options = arguments.parse_args()
    people = range(max(1, round(PEOPLE * options.share)))
    share = len(people) / PEOPLE
    walks = {person: (walk(person, False), walk(person, True)) for person in people}
    units = [(person, length) for length in reversed(LENGTHS_S) for person in people]  # the longest first
    given = [parts(walks[person], length) for person, length in units]
    print(f"{platform.machine()}, {os.cpu_count()} cores, torch {torch.__version__}; load {os.getloadavg()[0]:.1f}")
    print(f"{3 * len(units)} of 360 networks: {len(people)} of {PEOPLE} people, share {share:.3f}")
    sides: dict[str, list[Done]] = {}
    if options.only != "loop":
        sides["ours"] = run_ours(given, share, options)
    if options.only != "ours":
        sides["the loop"] = [users_loop(*unit) for unit in given]
        seconds, core = (
            sum(times) for times in zip(*((d.seconds, d.core_seconds) for d in sides["the loop"]), strict=True)
        )
        print(
            f"the loop: {seconds:.1f} s by the clock, {core:.1f} s of the core; whole study {core / share / 60:.1f} min"
        )
    print(f"load {os.getloadavg()[0]:.1f}")
    if len(sides) == 2:
        core = {name: sum(one.core_seconds for one in done) for name, done in sides.items()}
        print(f"one core: the loop takes {core['the loop'] / core['ours']:.1f} times as long")
        print_r2(units, sides)


def run_ours(given: list[tuple[Samples, Samples, Samples]], share: float, options: argparse.Namespace) -> list[Done]:
    with joblib.Parallel(n_jobs=options.processes, pre_dispatch="all") as parallel:
        begun = time.perf_counter()
        parallel(joblib.delayed(ours)(*given[-1], options.arithmetic) for _ in range(2 * options.processes))
        start = time.perf_counter() - begun
        begun = time.perf_counter()
        found = parallel(joblib.delayed(ours)(*unit, options.arithmetic) for unit in given)
        wall = time.perf_counter() - begun
    done = [one for one in found or () if one is not None]
    seconds, core = sum(one.seconds for one in done), sum(one.core_seconds for one in done)
    flop = sum(one.flop for one in done)
    rates = np.mean([rate for one in done for rate in one.rates], axis=0)
    print(f"ours ({options.arithmetic}), {options.processes} processes of one thread, {start:.1f} s to start them:")
    for name, spent, rate in (("by the clock", seconds, rates[0]), ("of the cores", core, rates[1])):
        each = spent / options.processes
        print(f"  {name}: {each:.1f} s, whole study {each / share:.0f} s (goal {GOAL_S:.0f}); a process has")
        found, there = flop / spent / 1e9, rate / 1e9
        print(f"    {found:.1f} of {there:.1f} GFLOP/s of 1024^3 products: {found / there:.0%} (goal {GOAL_RATE:.0%})")
    print(f"  {flop / 1e12:.2f} TFLOP of matrix products; wall clock with judging and measuring the rate {wall:.1f} s")
    return done


def print_r2(units: list[tuple[int, int]], sides: dict[str, list[Done]]) -> None:
    print("\nR2 on held-out device walking, median over people and the three models: the loop / ours (difference)\n")
    print("| training | " + " | ".join(VARIABLES) + " | least difference |")
    print("|---|" + "---|" * (len(VARIABLES) + 1))
    for length in LENGTHS_S:
        loop, found = (
            np.median([one.r2 for unit, one in zip(units, sides[name], strict=True) if unit[1] == length], axis=(0, 1))
            for name in ("the loop", "ours")
        )
        apart = found - loop
        cells = [f"{a:.3f} / {b:.3f} ({b - a:+.3f})" for a, b in zip(loop, found, strict=True)]
        print(
            f"| {length} s | {' | '.join(cells)} | {apart.min():+.4f}{'' if apart.min() >= -GOAL_R2 else ', missed'} |"
        )


if __name__ == "__main__":
    main()
