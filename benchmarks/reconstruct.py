"""Individual gait models: ours against the original SHRED's own loop, same data, same run, one thread.

    python benchmarks/reconstruct.py [--cap-s 200] [--seed 0] [--pyshred PYTHON]

Hip, knee and ankle of one leg give the other seven angles of W01 of the embedded cohort, 60 s, temporal split 70/10/20
with a gap.

The original, written here as its published code does it: every sample of 1 s of history (100 readings), LSTM 2 x 64,
decoder 350-400, no dropout, sensors and states scaled to [0, 1] by the training part, DataLoader of batch 64, shuffled,
Adam at 1e-3, scored on the check part every 20 epochs, weights of the best kept, stopped after five checks without
gain: no sooner than after 120 epochs, which is why --cap-s ends it. Its error on the test part is watched every
`WATCH` epochs, and the watching is left out of its time.

Ours: `fit_reconstructor` with its defaults, 25 readings over the same second; then all twelve people of the cohort one
after the other, and one fold of the population, of the kinds that are closed forms. Seconds are processor time.

--pyshred names the Python of an environment that has the packaged pyshred; it is run there on the same numbers for
`PACKAGED_EPOCHS` epochs (packaged_pyshred.py).
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--cap-s", "the original stops after so much processor time [s]", 200.0),
    argument("--seed", "of the fits", 0),
    argument("--pyshred", "the Python of an environment that has the packaged pyshred", type=Path),
)  # before the slow imports

import copy
import json
import os
import subprocess
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import torch
from numpy.typing import NDArray
from sensing_walks import SENSORS, Person, cohort_walks
from torch import Tensor, nn
from torch.utils.data import DataLoader, TensorDataset

from gaitdisc.models.trained_network import pin_threads
from gaitdisc.reconstruction.window_model import KINDS, fit_reconstructor
from gaitdisc.reconstruction.windows import Lags, Parts, split_by_subject
from gaitdisc.recording import Samples

EVERY_SAMPLE = Lags(100, 1)
CHECK_EVERY, PATIENCE, WATCH = 20, 5, 5
CLOSED = ("delay ridge", "fourier ridge")
PACKAGED_EPOCHS = 10


@dataclass(frozen=True)
class Watched:
    """Where a loop was after some time."""

    epoch: int
    seconds: float
    check: float
    rmse_deg: float


class OriginalShred(nn.Module):
    """Two LSTM layers of 64, their last hidden state decoded by 350 and 400 rectified nodes."""

    def __init__(self, sensors: int, states: int) -> None:
        super().__init__()
        self.lstm = nn.LSTM(sensors, 64, 2, batch_first=True)
        self.decoder = nn.Sequential(
            nn.Linear(64, 350), nn.ReLU(), nn.Linear(350, 400), nn.ReLU(), nn.Linear(400, states)
        )

    def forward(self, x: Tensor) -> Tensor:
        """States (window, state) from windows (window, reading, sensor)."""
        return self.decoder(self.lstm(x)[1][0][-1])


def main() -> None:
    with pin_threads(1):
        dense, sparse = (cohort_walks(1, lags=lags)[0] for lags in (EVERY_SAMPLE, Lags(25, 4)))
        watched = original(dense.parts(), dense.angles, GIVEN.cap_s, GIVEN.seed)
        ours(sparse.parts(), sparse, watched, GIVEN.seed)
        if GIVEN.pyshred:
            packaged(dense, GIVEN.pyshred)
        several(GIVEN.seed)


def rmse(states: NDArray[np.float64], samples: Samples, angles: Sequence[int]) -> float:
    """Over windows and angles [deg]."""
    return float(np.sqrt(np.mean((states - samples.y)[:, angles] ** 2)))


def original(parts: Parts, angles: list[int], cap_s: float, seed: int) -> list[Watched]:
    """Train the original SHRED, and watch it; the last entry is the error with its best weights."""
    torch.manual_seed(seed)
    training, check, test = parts.fitted(), parts.checked(), parts.tested()
    low, high = (np.concatenate([f(training.x, axis=0), f(training.y, axis=0)]) for f in (np.min, np.max))
    width = training.x.shape[1]
    unit = [_unit(s, low, high - low, width) for s in (training, check, test)]
    model = OriginalShred(len(SENSORS), training.y.shape[1])
    optimizer = torch.optim.Adam(model.parameters(), 1e-3)
    loader = DataLoader(TensorDataset(*unit[0]), 64, shuffle=True)
    best, kept, waited, spent, found = float("inf"), model.state_dict(), 0, 0.0, []
    epoch = 0
    while waited < PATIENCE and spent < cap_s:
        begun = time.process_time()
        model.train()
        for x, y in loader:
            optimizer.zero_grad()
            nn.functional.mse_loss(model(x), y).backward()
            optimizer.step()
        epoch += 1
        if epoch % CHECK_EVERY == 0:
            loss = float(nn.functional.mse_loss(_scaled_states(model, unit[1][0]), unit[1][1]))
            waited = 0 if loss < best else waited + 1
            if loss < best:
                best, kept = loss, copy.deepcopy(model.state_dict())
        spent += time.process_time() - begun
        if epoch % WATCH == 0 or spent >= cap_s:
            loss = float(nn.functional.mse_loss(_scaled_states(model, unit[1][0]), unit[1][1]))
            states = _scaled_states(model, unit[2][0]).double().numpy() * (high - low)[width:] + low[width:]
            found.append(Watched(epoch, spent, loss, rmse(states, test, angles)))
            print(f"  original, epoch {epoch}: {spent:.0f} s, {found[-1].rmse_deg:.3f} deg", flush=True)
    stopped = "its own rule" if waited >= PATIENCE else f"the cap of {cap_s:g} s"
    if best < float("inf"):
        model.load_state_dict(kept)
    states = _scaled_states(model, unit[2][0]).double().numpy() * (high - low)[width:] + low[width:]
    rate, error = 1e6 * spent / epoch / len(training), rmse(states, test, angles)
    print(f"original: {len(training)} windows, {rate:.0f} us a window and epoch; ended by {stopped}")
    print(f"original: {epoch} epochs, {spent:.0f} s, {error:.3f} deg with its best weights", flush=True)
    return [*found, Watched(epoch, spent, best, error)]


def ours(parts: Parts, person: Person, watched: list[Watched], seed: int) -> None:
    """Fit every kind, and say what the original needed for the same error."""
    final, angles = watched[-1], person.angles
    for kind in KINDS:
        done = fit_reconstructor(kind, person.what, parts.fitted(), parts.checked(), seed)
        error = rmse(done(parts.tested()), parts.tested(), angles)
        reached = next((w.seconds for w in watched if w.rmse_deg <= error), None)
        same = f"{reached:.0f} s, {reached / done.seconds:.0f} times as long" if reached else "did not reach it"
        faster = f"; at most its final error, {final.seconds / done.seconds:.0f} times as fast"
        said = faster if error <= final.rmse_deg else ""
        print(f"{kind}: {done.seconds:.2f} s, {error:.3f} deg; the original for that: {same}{said}", flush=True)


def packaged(person: Person, python: Path) -> None:
    """Run the packaged pyshred where it is installed, on the same walk."""
    [walk] = person.walks.people[person.name]
    names = [channel.name for channel in person.channels]
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "values.npy"
        np.save(file, walk.recording.selected(names).values)
        words = [python, Path(__file__).with_name("packaged_pyshred.py"), file, len(SENSORS), PACKAGED_EPOCHS]
        done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode:
        print(f"packaged pyshred: failed, {done.stderr.strip().splitlines()[-1]}")
        return
    result = json.loads(done.stdout.strip().splitlines()[-1])
    cost = f"{result['epochs']} epochs, {result['seconds']:.0f} s"
    print(f"packaged pyshred {result['version']}: {cost}, {result['rmse_deg']:.3f} deg")


def several(seed: int) -> None:
    """Twelve individual models, and one fold of the population."""
    people = cohort_walks()
    begun = time.process_time()
    parted = [person.parts() for person in people]
    windows_s = time.process_time() - begun
    fold = split_by_subject([person.windows() for person in people], 0)
    for kind in CLOSED:
        fits = [
            fit_reconstructor(kind, person.what, own.fitted(), own.checked(), seed)
            for person, own in zip(people, parted, strict=True)
        ]
        one = fit_reconstructor(kind, people[0].what, fold.fitted(), fold.checked(), seed)
        spent = sum(done.seconds for done in fits)
        print(f"{kind}: {len(fits)} individual models {spent:.1f} s, their windows {windows_s:.1f} s")
        print(f"{kind}: one fold of the population {one.seconds:.1f} s")


def _unit(samples: Samples, low: NDArray, span: NDArray, width: int) -> tuple[Tensor, Tensor]:
    x, y = (samples.x - low[:width]) / span[:width], (samples.y - low[width:]) / span[width:]
    shaped = x.reshape(len(x), -1, len(SENSORS))
    return torch.from_numpy(shaped.astype(np.float32)), torch.from_numpy(y.astype(np.float32))


def _scaled_states(model: nn.Module, x: Tensor) -> Tensor:
    model.eval()
    with torch.no_grad():
        return torch.cat([model(part) for part in x.split(2048)])


if __name__ == "__main__":
    main()
