"""Forced isotropic turbulence in a periodic box: a stand-in for the database that chapter 5 took its flow from."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.fft import irfftn, rfftn

from gaitdisc.errors import ReadError, SamplingError, SchemaError, ShapeError
from gaitdisc.recording import Source
from gaitdisc.recording.field import Axis, Field
from gaitdisc.whole_file import whole_file, write_whole

LEAST_NODES = 8
FORCED = 2.5  # wavenumbers up to it receive the power
Modes = NDArray[np.complexfloating]
SETTINGS, STATE, VALUES = "flow.json", "state.npz", "u.npy"
NUMBERS_EVERY = 10  # snapshots from one reckoning of the flow's numbers to the next
KEPT_EVERY = 50  # snapshots from one saved state to the next
RESOLVED = 1.3  # largest wavenumber times Kolmogorov's length that the viscosity is chosen for


@dataclass(frozen=True)
class Box:
    """A cube with so many nodes along each side, in the half of all wavenumbers that a real field needs."""

    nodes: int  # along each side; even, at least 8

    def __post_init__(self) -> None:
        """Refuse a box that is too coarse."""
        if self.nodes < LEAST_NODES or self.nodes % 2:
            raise ShapeError(
                f"a box of turbulence needs an even number of nodes, {LEAST_NODES} or more",
                f"requested: {self.nodes}",
                "Take 32, 48 or 64.",
            )

    @property
    def largest(self) -> int:
        """Largest wavenumber along an axis that is kept: two thirds of what the nodes resolve (no aliasing)."""
        return (self.nodes - 1) // 3

    @cached_property
    def k(self) -> NDArray[np.float32]:
        """Wavenumbers along x, y, z at every mode, (3, x, y, z)."""
        whole = np.fft.fftfreq(self.nodes, 1 / self.nodes).astype(np.float32)
        half = np.arange(self.nodes // 2 + 1, dtype=np.float32)
        return np.stack(np.meshgrid(whole, whole, half, indexing="ij"))

    @cached_property
    def squared(self) -> NDArray[np.float32]:
        """Square of the length of the wavenumber, (x, y, z)."""
        return (self.k**2).sum(axis=0)

    @cached_property
    def inverse(self) -> NDArray[np.float32]:
        """One over `squared`, 0 where that is 0."""
        return (1 / np.where(self.squared > 0, self.squared, np.inf)).astype(np.float32)

    @cached_property
    def kept(self) -> NDArray[np.bool_]:
        """True at modes that are computed: below the aliased ones, without the mean."""
        return (np.abs(self.k) <= self.largest).all(axis=0) & (self.squared > 0)

    @cached_property
    def weight(self) -> NDArray[np.float32]:
        """How many modes of the whole space each mode stands for: 2, or 1 on the plane that is its own mirror."""
        weight = np.full(self.squared.shape, 2.0, np.float32)
        weight[..., 0] = weight[..., -1] = 1.0
        return weight

    def to_modes(self, velocity: NDArray[np.floating]) -> Modes:
        """Fourier coefficients of a velocity, (3, x, y, z), as amplitudes: not times the number of nodes."""
        return np.asarray(rfftn(velocity, axes=(1, 2, 3), norm="forward"))

    def to_nodes(self, modes: Modes) -> NDArray[np.floating]:
        """Values at the nodes, (3, x, y, z)."""
        return np.asarray(irfftn(modes, s=(self.nodes,) * 3, axes=(1, 2, 3), norm="forward"))

    def projected(self, modes: Modes) -> Modes:
        """Take away the part that is a gradient, and modes that are not computed: what is left has no divergence."""
        along = (self.k * modes).sum(axis=0) * self.inverse
        return np.where(self.kept, modes - self.k * along, 0)

    def energy(self, modes: Modes) -> NDArray[np.float32]:
        """Kinetic energy per mass in every mode, (x, y, z), such that the sum is the mean over the box."""
        return 0.5 * self.weight * (modes.real**2 + modes.imag**2).sum(axis=0)


@dataclass(frozen=True)
class FlowNumbers:
    """Numbers of one instant, per mass, in units of box and time."""

    energy: float
    dissipation: float
    re_lambda: float
    kmax_eta: float  # largest wavenumber times Kolmogorov's length: 1 or more resolves the dissipation
    integral_length: float  # longitudinal
    turnover: float  # its time: length over root mean square velocity


def energy_spectrum(box: Box, u: Modes) -> NDArray[np.float64]:
    """Energy in shells of unit width around each whole wavenumber from 0; the sum is the energy."""
    shell = np.rint(np.sqrt(box.squared)).astype(int).ravel()
    return np.bincount(shell, weights=box.energy(u).astype(float).ravel()).astype(float)


def flow_numbers(box: Box, u: Modes, viscosity: float) -> FlowNumbers:
    """Energy, dissipation, and what follows from them for isotropic turbulence.

    Source: Pope 2000, Turbulent flows, section 6: lambda^2 = 15 viscosity u'^2 / dissipation, eta = (viscosity^3 /
        dissipation)^(1/4), L = pi / (2 u'^2) times the integral of E(k) / k.
    """
    each = box.energy(u).astype(float)
    energy = float(each.sum())
    dissipation = float(2 * viscosity * (box.squared * each).sum())
    speed = np.sqrt(2 * energy / 3)
    taylor = np.sqrt(15 * viscosity / dissipation) * speed
    eta = (viscosity**3 / dissipation) ** 0.25
    spectrum = energy_spectrum(box, u)
    length = float(np.pi / (2 * speed**2) * np.sum(spectrum[1:] / np.arange(1, len(spectrum))))
    re_lambda, resolved = float(speed * taylor / viscosity), float(box.largest * eta)
    return FlowNumbers(energy, dissipation, re_lambda, resolved, length, length / float(speed))


@dataclass(frozen=True)
class Stepper:
    """Navier-Stokes without pressure, by Fourier modes: Heun's method, viscosity exact by an integrating factor.

    The nonlinear term is u x vorticity (rotational form), projected; aliased products are cut off at two thirds of the
    wavenumbers. The force is along the velocity of the modes up to `FORCED`, as large as gives the wanted power
    whatever the flow does.

    Source: Rogallo 1981, Numerical experiments in homogeneous turbulence (integrating factor); Lamorgese, Caughey and
        Pope 2005 (deterministic forcing of constant power).
    """

    box: Box
    viscosity: float  # kinematic, in units of box and time
    power: float  # energy per mass and time that the force puts in; 0 lets the flow decay
    dt: float

    @cached_property
    def _damping(self) -> NDArray[np.float32]:
        return np.exp(-self.viscosity * self.box.squared * self.dt).astype(np.float32)

    @cached_property
    def _forced(self) -> NDArray[np.bool_]:
        return self.box.kept & (self.box.squared <= FORCED**2)

    def step(self, u: Modes) -> Modes:
        """Return the velocity one step later."""
        first = self.rates(u)
        ahead = self._damping * (u + self.dt * first)
        second = self.rates(ahead)
        later = self._damping * (u + 0.5 * self.dt * first) + 0.5 * self.dt * second
        if not np.isfinite(later[:, 0, 0, 1]).all():
            raise SamplingError(
                "a step of turbulence has to be shorter than the flow needs to pass a node",
                f"with steps of {self.dt:g} the velocity is not finite any more",
                "Take half the step.",
            )
        return later

    def rates(self, u: Modes) -> Modes:
        """Rate of the velocity without viscosity: advection and force."""
        box = self.box
        velocity, vorticity = box.to_nodes(u), box.to_nodes(_crossed(box.k, u) * u.dtype.type(1j))
        rate = box.projected(box.to_modes(_crossed(velocity, vorticity)))
        if not self.power:
            return rate
        there = float(box.energy(u)[self._forced].sum(dtype=float))
        return rate + np.where(self._forced, u * (self.power / (2 * there)), 0).astype(u.dtype, copy=False)


def _crossed(a: NDArray, b: NDArray) -> NDArray:
    return np.stack([a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)])


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


def first_velocity(box: Box, energy: float, seed: int) -> Modes:
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
    shape, mode = (settings.snapshots, settings.cut**3), "r+" if done and (folder / VALUES).exists() else "w+"
    values = np.lib.format.open_memmap(folder / VALUES, mode=mode, dtype=np.float32, shape=shape)
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
            spectrum = energy_spectrum(box, u)[1 : box.largest + 1]
            shells = {f"e_{k}": float(value) for k, value in enumerate(spectrum, 1)}
            rows.append({"snapshot": snapshot, **asdict(flow_numbers(box, u, settings.viscosity)), **shells})
        if (snapshot + 1) % KEPT_EVERY == 0 or snapshot + 1 == settings.snapshots:
            values.flush()
            with whole_file(folder / STATE) as part, part.open("wb") as file:
                np.savez(file, u=u, done=np.array(snapshot + 1), rows=np.array(json.dumps(rows)))
        if progress:
            progress(1 - (settings.snapshots - snapshot - 1) * settings.every / whole)
    cut, kept = settings.cut, np.load(folder / VALUES, mmap_mode="r")
    axes = tuple(Axis(name, 2 * np.pi / settings.nodes * np.arange(float(cut))) for name in "xyz")
    time = np.arange(float(settings.snapshots)) * settings.every * settings.dt
    source = Source("", "", f"gaitdisc turbulence, {settings.nodes} nodes, seed {settings.seed}")
    field = Field(time, kept[:, :, None], axes, np.ones((cut,) * 3, bool), ("u",), ("1",), "s", source)
    return field, pd.DataFrame(rows)


def _begun(settings: FlowSettings, box: Box, folder: Path) -> tuple[Modes, int, list[dict[str, float]]]:
    path, delete = folder / SETTINGS, "Delete the folder."
    if path.exists():
        try:
            there = dict(json.loads(path.read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError) as error:
            wrong = f"{SETTINGS} cannot be read: {error}"
            raise ReadError("a flow is to go on by its settings", wrong, delete) from error
        other = [f"{name} {there.get(name)}" for name, value in asdict(settings).items() if there.get(name) != value]
        if there != asdict(settings):
            raise SchemaError(
                "a folder of turbulence needs the settings that its flow was begun with",
                f"{folder.name} has {', '.join(other)}",
                "Name another folder, or delete this one.",
            )
    else:
        write_whole(path, json.dumps(asdict(settings), indent=1) + "\n")
    if not (folder / STATE).exists():
        return first_velocity(box, 1.5 * settings.power ** (2 / 3), settings.seed), 0, []
    try:
        with np.load(folder / STATE, allow_pickle=False) as state:
            return state["u"], int(state["done"]), json.loads(str(state["rows"]))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        wrong = f"{STATE} cannot be read: {error}"
        raise ReadError("an interrupted flow is to go on from its state", wrong, delete) from error
