"""Training all networks of chapter 4: ours against the loop a user would write, on the embedded cohort.

    python benchmarks/train_networks.py [--people 12] [--processes 2] [--only ours|loop] [--seed 0] [--arithmetic auto]

The study: twelve people, ten lengths of the training part (1 s to all of 210 s at 100 Hz), three networks each
(Nominal, Exo, Discrepancy): 360 networks of 49 inputs, 64 and 64 nodes, 8 outputs, tested on 30 s held out.

The loop: PyTorch, DataLoader, batch 64, Adam at 1e-3, 30 epochs, one network after the other, one thread (two are
slower). It takes a quarter of an hour, so every person and length is recorded as it is done in
`train_networks_loop.jsonl`, with the hash of its samples and of its own code, and is not run again while these hold;
a run that was stopped goes on. Further seeds of the loop show how far it differs from itself.

Ours: `fit_models` with its defaults, decays and penalties chosen on inner blocks, in processes of one thread. Before
and after each length our side multiplies matrices of 1024 x 1024 in float32, so that its share of the machine's rate
is one of what neighbours left at that time. Starting processes is counted apart: it is paid once.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--people", "the first so many of the twelve", 12),
    argument("--processes", "side by side, one thread each", 2),
    argument("--only", "one side; loop: only run and record it", choices=("ours", "loop")),
    argument("--seed", "of the loop", 0),
    argument("--most", "no lengths above this [s]", 210),
    argument("--arithmetic", "of our side", "auto", choices=("auto", "torch")),
)  # before the slow imports

import hashlib
import inspect
import json
import os
import platform
import time
from argparse import Namespace
from collections.abc import Callable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime

os.environ.setdefault("OMP_NUM_THREADS", "1")

import joblib
import numpy as np
import torch
from cohort_samples import PersonSamples, person_samples
from numpy.typing import NDArray
from torch import nn
from torch.utils.data import DataLoader, TensorDataset

from gaitdisc.models import trainer
from gaitdisc.models.trained_network import pin_threads
from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.recording import Samples
from gaitdisc.response.fit_response import fit_models, fit_network
from gaitdisc.statistics.r2 import r2

PEOPLE = 12
LENGTHS_S = (1, 10, 20, 30, 45, 60, 90, 120, 180, 210)
VARIABLES = ("hip", "knee", "ankle", "HAM", "RF", "VAS", "GAS", "SOL")
MODELS = ("nominal", "augmented", "exo")
FORWARD = 2 * (49 * 64 + 64 * 64 + 64 * 8)  # FLOP of the matrix products for one sample
FORWARD_BACKWARD = 2 * FORWARD + 2 * (64 * 64 + 64 * 8)  # no gradient of the inputs
GOAL_S, GOAL_R2, GOAL_RATE = 60.0, 0.005, 0.45
RECORD = Path(__file__).with_name("train_networks_loop.jsonl")

Parts = tuple[Samples, Samples, Samples]


@dataclass(frozen=True)
class Done:
    """A person and length: R2 (model, variable), seconds by the clock and of the core; ours: matrix work, rates."""

    r2: list[list[float]]
    seconds: float
    core_seconds: float
    flop: float = 0.0
    rates: tuple[tuple[float, float], ...] = ()


def ours(nominal: Samples, exo: Samples, held_out: Samples, arithmetic: str) -> Done:
    """Three networks by the package, with the machine's matrix rate before and after."""
    settings = TrainingSettings(arithmetic=arithmetic)
    work: list[float] = []
    counted = _counted(work)
    trainer.descend, plain = counted, trainer.descend
    rates = [matrix_rate()]
    try:
        begun, begun_core = time.perf_counter(), time.process_time()
        models = fit_models(nominal, exo, lambda samples, progress: fit_network(samples, settings, progress))
        seconds, core_seconds = time.perf_counter() - begun, time.process_time() - begun_core
    finally:
        trainer.descend = plain
    rates.append(matrix_rate())
    on_exo = models.on_exo()
    found = [r2(held_out.y, on_exo[name](held_out.x)).tolist() for name in MODELS]
    return Done(found, seconds, core_seconds, sum(work), tuple(rates))


def _counted(work: list[float]) -> Callable:
    plain = trainer.descend

    def descend(network, part, check, *rest):
        done = plain(network, part, check, *rest)
        work.append(len(done) * (len(part[0]) * FORWARD_BACKWARD + len(check[0]) * FORWARD))
        return done

    return descend


def matrix_rate(products: int = 4) -> tuple[float, float]:
    """Float32 matrix products of one thread, by the clock and by the core's time [FLOP/s]."""
    square = np.ones((1024, 1024), np.float32)
    with pin_threads(1):
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


def users_fit(
    x: NDArray[np.float64], y: NDArray[np.float64], seed: int
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    torch.manual_seed(seed)
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


def users_loop(nominal: Samples, exo: Samples, held_out: Samples, seed: int) -> Done:
    """Three networks by the loop, one after the other."""
    with pin_threads(1):
        begun, begun_core = time.perf_counter(), time.process_time()
        f, y = users_fit(nominal.x, nominal.y, seed), users_fit(exo.x, exo.y, seed)
        g = users_fit(exo.x, exo.y - f(exo.x), seed)
        seconds, core_seconds = time.perf_counter() - begun, time.process_time() - begun_core
    x = held_out.x
    predictions = {"nominal": f(x), "augmented": f(x) + g(x), "exo": y(x)}
    return Done([r2(held_out.y, predictions[name]).tolist() for name in MODELS], seconds, core_seconds)


def recorded_loop(
    walks: dict[int, PersonSamples], units: list[tuple[int, int]], seed: int, run: bool = True
) -> dict[tuple[int, int], Done]:
    """Loop on all units: those on record for these samples and this code are taken, the rest is run and recorded."""
    code = hashlib.sha256("".join(map(inspect.getsource, (UsersNetwork, users_fit, users_loop))).encode()).hexdigest()
    keys = {person: f"{samples_key(samples)} {code[:12]}" for person, samples in walks.items()}
    found: dict[tuple[int, int], Done] = {}
    for line in RECORD.read_text().splitlines() if RECORD.is_file() else ():
        one = json.loads(line)
        if one["seed"] == seed and keys.get(one["person"]) == one["key"]:
            found[one["person"], one["length_s"]] = Done(one["r2"], one["seconds"], one["core_seconds"])
    left = [unit for unit in units if unit not in found] if run else []
    print(f"the loop, seed {seed}: {len(found)} of {len(units)} people and lengths on record, {len(left)} to run")
    for person, length in left:
        load = os.getloadavg()[0]
        done = users_loop(*walks[person].first(length), seed)
        rounded = Done(np.round(done.r2, 5).tolist(), round(done.seconds, 3), round(done.core_seconds, 3))
        circumstances = {
            "person": person,
            "length_s": length,
            "seed": seed,
            "key": keys[person],
            "load": round(load, 1),
        }
        circumstances |= {"torch": torch.__version__, "date": datetime.now(UTC).date().isoformat()}
        with RECORD.open("a") as record:
            record.write(json.dumps(circumstances | {k: v for k, v in asdict(rounded).items() if v}) + "\n")
        found[person, length] = rounded
    return {unit: found[unit] for unit in units if unit in found}


def samples_key(samples: PersonSamples) -> str:
    arrays = (samples.nominal.x, samples.nominal.y, samples.exo.x, samples.exo.y, samples.held_out.y)
    return hashlib.sha256(b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)).hexdigest()[:12]


def main() -> None:
    print(f"{platform.machine()}, {os.cpu_count()} cores, torch {torch.__version__}; load {os.getloadavg()[0]:.1f}")
    begun = time.perf_counter()
    walks = {number: person_samples(number) for number in range(GIVEN.people)}
    print(f"{GIVEN.people} people walked and were processed in {time.perf_counter() - begun:.0f} s, one process")
    lengths = [length for length in reversed(LENGTHS_S) if length <= GIVEN.most]  # the longest first
    units = [(person, length) for length in lengths for person in walks]
    mine = {}
    if GIVEN.only != "loop":
        mine = dict(zip(units, run_ours([walks[p].first(s) for p, s in units], GIVEN), strict=True))
    loop = recorded_loop(walks, units, GIVEN.seed, GIVEN.only != "ours")
    if loop:
        seconds, core = (sum(getattr(d, name) for d in loop.values()) for name in ("seconds", "core_seconds"))
        print(f"the loop, {3 * len(loop)} networks: {seconds:.0f} s by the clock, {core:.0f} s of the core")
    if mine and loop:
        both = [unit for unit in units if unit in loop]
        shares = [sum(side[unit].core_seconds for unit in both) for side in (loop, mine)]
        print(f"one core: the loop takes {shares[0] / shares[1]:.1f} times as long")
        print_r2(mine, loop, recorded_loop(walks, units, GIVEN.seed + 1, run=False))
    print(f"load {os.getloadavg()[0]:.1f}")


def run_ours(given: list[Parts], options: Namespace) -> list[Done]:
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
    print(
        f"ours ({options.arithmetic}), {3 * len(done)} networks, {options.processes} processes of one thread, ", end=""
    )
    print(f"{start:.1f} s to start them:")
    for name, spent, rate in (("by the clock", seconds, rates[0]), ("of the cores", core, rates[1])):
        each, found, there = spent / options.processes, flop / spent / 1e9, rate / 1e9
        print(f"  {name}: {each:.1f} s a process (goal {GOAL_S:.0f} for all 360); a process has {found:.1f} of", end="")
        print(f" {there:.1f} GFLOP/s of 1024^3 products: {found / there:.0%} (goal {GOAL_RATE:.0%})")
    print(f"  {flop / 1e12:.2f} TFLOP of matrix products; wall clock with judging and measuring the rate {wall:.1f} s")
    return done


def print_r2(
    mine: dict[tuple[int, int], Done], loop: dict[tuple[int, int], Done], again: dict[tuple[int, int], Done]
) -> None:
    """Medians over people and models, and the worst variable of any one model, beside the loop's own spread."""
    print("\nR2 on held-out device walking, median over people and the three models: the loop / ours (difference)\n")
    head = "least difference | of one model | loop of the next seed, least | of one model"
    print(f"| training | {' | '.join(VARIABLES)} | {head} |\n{'|---' * (len(VARIABLES) + 5)}|")
    for length in sorted({unit[1] for unit in loop}):
        of = [np.array([d.r2 for u, d in side.items() if u[1] == length]) for side in (loop, mine, again)]
        a, b = (np.median(side, axis=(0, 1)) for side in of[:2])
        cells = [f"{x:.3f} / {y:.3f} ({y - x:+.3f})" for x, y in zip(a, b, strict=True)]
        for other in of[1:]:
            if len(other) != len(of[0]):
                cells += ["", ""]
                continue
            least = (np.median(other, axis=(0, 1)) - a).min()
            one = (np.median(other, axis=0) - np.median(of[0], axis=0)).min()
            cells += [f"{least:+.4f}{'' if least >= -GOAL_R2 else ', missed'}", f"{one:+.4f}"]
        print(f"| {length} s | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
