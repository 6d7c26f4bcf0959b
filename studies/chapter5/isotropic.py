"""Forced isotropic turbulence, recorded: spun up, then cut out snapshot by snapshot into a folder that can go on."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, SchemaError, ShapeError
from gaitdisc.recording import Axis, Field, Source
from gaitdisc.whole_file import whole_file, write_whole

from .box import Box
from .spectrum import energy_spectrum, flow_numbers
from .stepping import Stepper

SETTINGS, STATE, VALUES = "flow.json", "state.npz", "u.npy"
NUMBERS_EVERY = 10  # snapshots from one reckoning of the flow's numbers to the next
KEPT_EVERY = 50  # snapshots from one saved state to the next
RESOLVED = 1.3  # largest wavenumber times Kolmogorov's length that the viscosity is chosen for


@dataclass(frozen=True)
class FlowSettings:
    """How a flow is made and what of it is kept."""

    nodes: int = 48
    cut: int = 40  # nodes of the cube that is kept along each side, from a corner
    snapshots: int = 1257
    every: int = 2  # steps from one snapshot to the next
    spin_up: int = 1500
    power: float = 0.1  # energy put in per mass and time
    seed: int = 0

    def __post_init__(self) -> None:
        """Refuse what keeps nothing."""
        if not 1 < self.cut <= self.nodes or min(self.snapshots, self.every) < 1 or self.spin_up < 0:
            raise ShapeError(
                f"a record of turbulence needs a cut of 2 to {self.nodes} nodes, and snapshots",
                f"requested: {self.cut} nodes, {self.snapshots} snapshots {self.every} steps apart",
                "Correct the settings.",
            )

    @property
    def viscosity(self) -> float:
        """As small as the nodes resolve."""
        eta = RESOLVED / Box(self.nodes).largest
        return (eta**4 * self.power) ** (1 / 3)

    @property
    def dt(self) -> float:
        """Step that is short for the fastest places."""
        return 0.15 / (Box(self.nodes).largest * self.power ** (1 / 3))


def first_velocity(box: Box, energy: float, seed: int) -> NDArray[np.complexfloating]:
    """Random velocity without divergence, most of it in the largest scales."""
    noise = np.random.default_rng(seed).normal(size=(3, *(box.nodes,) * 3)).astype(np.float32)
    u = box.projected(box.to_modes(noise) * (box.squared * np.exp(-box.squared / 4)))
    return u * np.float32(np.sqrt(energy / float(box.energy(u).sum(dtype=float))))


def record_turbulence(
    settings: FlowSettings, folder: Path, progress: Callable[[float], None] | None = None
) -> tuple[Field, pd.DataFrame]:
    """Compute a flow, or go on with one that was interrupted, and give what is kept of it."""
    folder.mkdir(parents=True, exist_ok=True)
    box = Box(settings.nodes)
    stepper = Stepper(box, settings.viscosity, settings.power, settings.dt)
    u, done, rows = _begun(settings, box, folder)
    values = _values(settings, folder, done)
    spin_up = 0 if rows or done else settings.spin_up
    whole = settings.snapshots * settings.every + settings.spin_up
    for step in range(spin_up):
        u = stepper.step(u)
        if progress and step % 20 == 0:
            progress(step / whole)
    for snapshot in range(done, settings.snapshots):
        if snapshot:
            for _ in range(settings.every):
                u = stepper.step(u)
        values[snapshot] = box.to_nodes(u)[0, : settings.cut, : settings.cut, : settings.cut].ravel()
        if snapshot % NUMBERS_EVERY == 0:
            rows.append(_row(box, u, settings.viscosity, snapshot))
        if (snapshot + 1) % KEPT_EVERY == 0 or snapshot + 1 == settings.snapshots:
            values.flush()
            _keep(folder, u, snapshot + 1, rows)
        if progress:
            progress(1 - (settings.snapshots - snapshot - 1) * settings.every / whole)
    return _field(settings, folder), pd.DataFrame(rows)


def _row(box: Box, u: NDArray[np.complexfloating], viscosity: float, snapshot: int) -> dict[str, float]:
    spectrum = energy_spectrum(box, u)[1 : box.largest + 1]
    shells = {f"e_{k}": float(value) for k, value in enumerate(spectrum, 1)}
    return {"snapshot": snapshot, **asdict(flow_numbers(box, u, viscosity)), **shells}


def _begun(
    settings: FlowSettings, box: Box, folder: Path
) -> tuple[NDArray[np.complexfloating], int, list[dict[str, float]]]:
    path = folder / SETTINGS
    if path.exists():
        try:
            there = dict(json.loads(path.read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError) as error:
            raise ReadError(
                "a flow is to go on by its settings", f"{SETTINGS} cannot be read: {error}", "Delete the folder."
            ) from error
        if there != asdict(settings):
            other = [
                f"{name} {there.get(name)}" for name, value in asdict(settings).items() if there.get(name) != value
            ]
            raise SchemaError(
                "a folder of turbulence needs the settings that its flow was begun with",
                f"{folder.name} has {', '.join(other)}",
                "Name another folder, or delete this one.",
            )
    else:
        write_whole(path, json.dumps(asdict(settings), indent=1) + "\n")
    if not (folder / STATE).exists():
        energy = 1.5 * settings.power ** (2 / 3)
        return first_velocity(box, energy, settings.seed), 0, []
    try:
        with np.load(folder / STATE, allow_pickle=False) as state:
            return state["u"], int(state["done"]), json.loads(str(state["rows"]))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise ReadError(
            "an interrupted flow is to go on from its state", f"{STATE} cannot be read: {error}", "Delete the folder."
        ) from error


def _values(settings: FlowSettings, folder: Path, done: int) -> np.memmap:
    shape = (settings.snapshots, settings.cut**3)
    path = folder / VALUES
    if done and path.exists():
        return np.lib.format.open_memmap(path, mode="r+")
    return np.lib.format.open_memmap(path, mode="w+", dtype=np.float32, shape=shape)


def _keep(folder: Path, u: NDArray[np.complexfloating], done: int, rows: list[dict[str, float]]) -> None:
    with whole_file(folder / STATE) as part, part.open("wb") as file:
        np.savez(file, u=u, done=np.array(done), rows=np.array(json.dumps(rows)))


def _field(settings: FlowSettings, folder: Path) -> Field:
    values = np.load(folder / VALUES, mmap_mode="r")
    step = 2 * np.pi / settings.nodes
    axes = tuple(Axis(name, step * np.arange(float(settings.cut))) for name in "xyz")
    time = np.arange(float(settings.snapshots)) * settings.every * settings.dt
    source = Source("", "", f"gaitdisc turbulence, {settings.nodes} nodes, seed {settings.seed}")
    mask = np.ones((settings.cut,) * 3, bool)
    return Field(time, values[:, :, None], axes, mask, ("u",), ("1",), "s", source)
