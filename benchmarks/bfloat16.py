"""Training in bfloat16: processor time of one window of a descent, for recurrent cells and batches, on one thread.

    python benchmarks/bfloat16.py

Forward, backward and Adam on random windows of 25 readings of three sensors, 15 states; the least of six tries.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import command_line

command_line(__name__, __doc__)  # before the slow imports

import os
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import torch

from gaitdisc.models.networks import Shred
from gaitdisc.models.trained_network import torch_threads
from gaitdisc.models.trainer import TorchSteps
from gaitdisc.models.training_settings import PRECISIONS, ScaledSamples, TrainingSettings, make_schedule

STEPS, TRIES = 3, 6


def main() -> None:
    for cell, layers in (("gru", 1), ("lstm", 1), ("lstm", 2)):
        for batch in (128, 512):
            each = [microseconds(cell, layers, batch, precision) for precision in PRECISIONS]
            print(f"{cell} {layers} x 64, batch {batch}: float32 {each[0]:.0f}, bfloat16 {each[1]:.0f} us a window, "
                  f"{each[0] / each[1]:.2f} times as fast", flush=True)  # fmt: skip


def microseconds(cell: str, layers: int, batch: int, precision: str) -> float:
    """Processor time of one window in one step of the descent."""
    torch.manual_seed(0)
    part = ScaledSamples(torch.randn(STEPS * batch, 75), torch.randn(STEPS * batch, 15))
    schedule = make_schedule(len(part[0]), 0.01, TrainingSettings(batch=batch))
    steps = TorchSteps(Shred(75, 15, 3, 64, layers, cell), part, part, schedule, precision)
    found = []
    with torch_threads(1):
        for _ in range(TRIES):
            begun = time.process_time()
            steps.epoch(torch.arange(STEPS * batch), schedule.rates[0])
            found.append(time.process_time() - begun)
    return 1e6 * min(found) / (STEPS * batch)


if __name__ == "__main__":
    main()
