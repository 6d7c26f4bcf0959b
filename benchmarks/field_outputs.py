"""SHRED with 125,000 outputs: raw points against modes of the field, per epoch, in memory, and in error.

    python benchmarks/field_outputs.py FOLDER [--epochs 30] [--text-epochs 3] [--energy 0.99]

The flow: forced isotropic turbulence in a box of 50 x 50 x 50 nodes (computed once into FOLDER/flow), 600 snapshots,
one fixed sensor, windows drawn at random (they leak; both sides alike). Each training runs in a process of its own on
one thread, so that its peak memory is its own; the same steps, batches and learning rates on both sides.

ours: one GRU of 64 and a decoder of 128 and 128, 13 readings 8 snapshots apart. text: two LSTM layers of 64 and a
decoder of 350 and 400, 100 readings, as the dissertation has it, for its cost alone.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("folder", "where the flow goes; what is there is not computed again", type=Path),
    argument("--epochs", "of our network", 30),
    argument("--text-epochs", "of the dissertation's network", 3),
    argument("--energy", "share that the modes keep", 0.99),
    argument("--one", "train one alone, print one line of JSON", nargs=2, metavar=("NETWORK", "TARGETS")),
)  # before the slow imports

import json
import os
import re
import subprocess
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from chapter5.reconstruct_field import FieldTask, prepare
from chapter5.routes import fixed_at_random
from chapter5.turbulence import FlowSettings, record_turbulence

from gaitdisc.reconstruction.windows import RANDOM, Lags

FLOW = FlowSettings(nodes=50, cut=50, snapshots=600, spin_up=800)
LAGS = {"ours": Lags(13, 8), "text": Lags(100, 1)}
BATCH, RATE, DECAY = 64, 3e-3, 0.01


def main() -> None:
    if GIVEN.one:
        network, targets = GIVEN.one
        epochs = GIVEN.epochs if network == "ours" else GIVEN.text_epochs
        print(json.dumps(trained(GIVEN.folder, network, targets, epochs)))
        return
    for network in LAGS:
        write_parts(GIVEN.folder, network, GIVEN.energy)
    print(
        "| network | targets | outputs | weights | s an epoch | peak beyond libraries [MB] | relative L2, test part |"
    )
    print("|---|---|---|---|---|---|---|")
    found = {}
    for network in LAGS:
        for targets in ("raw", "modes"):
            command = [sys.executable, *sys.argv, "--one", network, targets]
            said = subprocess.run(command, stdout=subprocess.PIPE, check=True)
            row = found[network, targets] = json.loads(said.stdout)
            print(f"| {network} | {targets} | {row['outputs']} | {row['weights']:,} | {row['epoch_s']:.3f} | "
                  f"{row['peak_mb']:.0f} | {row['relative_l2']:.4f} |", flush=True)  # fmt: skip
        raw, modes = found[network, "raw"], found[network, "modes"]
        ratio = {name: raw[name] / modes[name] for name in ("epoch_s", "peak_mb", "relative_l2")}
        print(f"{network}: modes {ratio['epoch_s']:.1f} times cheaper an epoch, {ratio['peak_mb']:.1f} times less "
              f"memory, error {1 / ratio['relative_l2']:.4f} of raw; modes fitted once in "
              f"{modes['modes_s']:.1f} s")  # fmt: skip


def write_parts(folder: Path, network: str, energy: float) -> None:
    """Windows, raw targets and modes of one network, for the processes that train."""
    flow, _ = record_turbulence(FLOW, folder / "flow")
    begun = time.process_time()
    ready = prepare(flow, fixed_at_random(flow, 1, 0), FieldTask("flow", LAGS[network], RANDOM, energy))
    seconds = time.process_time() - begun
    rows = [np.rint(part.time).astype(int) for part in (ready.training, ready.test)]
    x_mean, x_sd = ready.training.x.mean(), ready.training.x.std()
    modes = {"modes_s": seconds, "mean": ready.targets.modes.mean, "spread": ready.targets.modes.spread}
    parts = {"training": (ready.training.x - x_mean) / x_sd, "test": (ready.test.x - x_mean) / x_sd}
    np.savez(folder / f"{network}-windows.npz", test_rows=rows[1], **modes, **parts)
    np.savez(folder / f"{network}-modes.npz", basis=ready.targets.modes.basis, y=ready.training.y)
    np.save(
        folder / f"{network}-raw.npy",
        ((flow.values[rows[0]] - ready.targets.modes.mean) / ready.targets.modes.spread)[:, :, 0],
    )


def trained(folder: Path, network: str, targets: str, epochs: int) -> dict[str, float]:
    """Train on one kind of targets and test in the field."""
    import torch

    from gaitdisc.models.trainer import TorchSteps
    from gaitdisc.models.training_settings import ScaledSamples, TrainingSettings, make_schedule

    torch.set_num_threads(1)
    torch.manual_seed(0)
    before = peak_mb()
    windows = np.load(folder / f"{network}-windows.npz")
    raw = targets == "raw"
    y = np.load(folder / f"{network}-raw.npy") if raw else np.load(folder / f"{network}-modes.npz")["y"]
    sd = 1.0 if raw else float(np.sqrt(np.mean(y**2)))
    y = y if raw else (y / sd).astype(np.float32)
    x, y = torch.from_numpy(windows["training"].astype(np.float32)), torch.from_numpy(y)
    model = built(network, x.shape[1], y.shape[1])
    settings = TrainingSettings(epochs=epochs, batch=BATCH, learning_rate=RATE)
    rates = make_schedule(len(x), DECAY, settings).rates
    steps = TorchSteps(model, ScaledSamples(x, y), ScaledSamples(x[:1], y[:1]), make_schedule(len(x), DECAY, settings))
    order, seconds = torch.Generator().manual_seed(0), []
    for epoch in range(epochs):
        begun = time.process_time()
        steps.epoch(torch.randperm(len(x), generator=order), rates[epoch * len(rates) // epochs])
        seconds.append(time.process_time() - begun)
    peak = peak_mb() - before
    model.eval()
    with torch.no_grad():
        reconstructed = model(torch.from_numpy(windows["test"].astype(np.float32))).numpy() * sd
    reconstructed = reconstructed if raw else reconstructed @ np.load(folder / f"{network}-modes.npz")["basis"].T
    truth = np.load(folder / "flow" / "u.npy", mmap_mode="r")[windows["test_rows"]]
    error = reconstructed * windows["spread"][0] + windows["mean"][:, 0] - truth
    return {
        "outputs": y.shape[1], "weights": sum(p.numel() for p in model.parameters()),
        "epoch_s": float(np.median(seconds)), "peak_mb": peak, "modes_s": float(windows["modes_s"]),
        "relative_l2": float(np.linalg.norm(error) / np.linalg.norm(truth)),
    }  # fmt: skip


def peak_mb() -> float:
    """Largest resident memory of this process so far; getrusage would count the parent's."""
    found = re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())
    assert found is not None  # Linux reports it
    return int(found.group(1)) / 1024


def built(network: str, inputs: int, outputs: int):
    """Network by its name."""
    from gaitdisc.reconstruction.window_model import OF_TEXT, make_network

    return make_network("shred" if network == "ours" else OF_TEXT, 1)(inputs, outputs)


if __name__ == "__main__":
    main()
