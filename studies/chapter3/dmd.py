"""Dynamic mode decomposition with delays, optimised and exact: a few oscillations as functions of time."""

from __future__ import annotations

import contextlib
import io
import warnings
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SamplingError, TrainingError
from gaitdisc.recording import Samples, fit_scale

from .sindy import chapter3_library

DELAYS, RANK = 100, 15  # of the published code
TIME = "t"
UNEVEN = 1e-6  # of a sample
MOST_ITERATIONS = 60  # of variable projection
MOST_COLUMNS = 600  # of the Hankel matrix: evenly in time, since neighbours hold the same samples
SMALLEST = 1e-12  # of the largest eigenvalue, a millionth in size: rounding, about 1e-15, stays far below
SMALLEST_TURN = 1e-6  # |eigenvalue| of the map below which a mode dies within a sample: rounding, or noise


@dataclass(frozen=True, eq=False)
class Dmd:
    """A sum of modes in time; a `gaitdisc.model.Model` whose only input is time."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    modes: NDArray[np.complex128]  # of complex (mode, output) [output's unit], with their amplitudes at `start`
    # of complex (mode,) [1/s], growth and angular frequency; the growth is not above zero
    eigenvalues: NDArray[np.complex128]
    start: float  # [s], time that the amplitudes belong to
    # (mode,) [1/s], standard deviation of the eigenvalues over the bags of BOP-DMD; zero without bags
    spread: NDArray[np.float64]

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) for times (sample, 1) [s]; before the start, where what dies out explodes, held."""
        since = np.maximum(np.asarray(x)[:, 0] - self.start, 0.0)
        return np.real(np.exp(np.outer(since, self.eigenvalues)) @ self.modes)


def fit_dmd(samples: Samples, delays: int = DELAYS, rank: int = RANK, bags: int = 0, seed: int = 0) -> Dmd:
    """Fit modes to the outputs, which are stacked with their delays (Hankel matrix).

    The Hankel matrix is projected on its first `rank` left singular vectors, and at most 600 of its columns, evenly in
    time, go into the variable projection: it takes seconds instead of minutes on 3,000 samples. Modes that die out by
    twelve orders within one sample are left out, as in exact DMD.

    Source: Askham and Kutz 2018, SIAM J. Appl. Dyn. Syst. 17:380; Sashidhar and Kutz 2022, Phil. Trans. R. Soc. A
        380:20210199. The published code of chapter 3 has 100 delays and 15 modes that do not grow.
    """
    hankel = delayed(samples, delays, rank)
    axes, size, count = hankel.axes, hankel.size, hankel.columns.shape[1]
    some = np.unique(np.linspace(0, count - 1, min(MOST_COLUMNS, count)).astype(int))
    times = samples.time[some] - samples.time[0]
    found = _modes(axes.T @ hankel.columns[:, some], times, (axes.shape[1], bags, seed))
    modes = (axes[: len(size)] @ found.modes * size[:, None] * found.amplitudes).T
    values = np.asarray(found.eigs, np.complex128)
    spread = np.asarray(found.eigenvalues_std if bags else np.zeros(len(values)), float)
    # what has died out before the next sample says nothing of the record: its eigenvalue is rounding
    kept = np.exp(values.real * float(np.mean(np.diff(samples.time)))) > SMALLEST
    return Dmd((TIME,), samples.outputs, modes[kept], values[kept], float(samples.time[0]), spread[kept])


class Hankel(NamedTuple):
    """Outputs stacked with their delays."""

    columns: NDArray[np.float64]  # (delay x output, column), outputs over their size
    # (delay x output, mode), first left singular vectors, less those whose singular values are rounding
    axes: NDArray[np.float64]
    size: NDArray[np.float64]  # (output,), root mean square


def delayed(samples: Samples, delays: int, rank: int) -> Hankel:
    """Stack the outputs of even samples with their delays, or refuse what is too short or uneven."""
    least = delays + 2 * rank
    if len(samples) < least:
        raise SamplingError(
            f"{rank} modes with {delays} delays need {least} samples",
            f"there are {len(samples)}, {least - len(samples)} too few",
            "Record longer, or take fewer delays or modes.",
        )
    still, moving = fit_scale(samples.y).constant, samples
    if still.any() and not still.all():  # a field may have many outputs that stand still
        names = tuple(np.array(samples.outputs)[~still])
        moving = replace(samples, y=samples.y[:, ~still], outputs=names)
    moving.trainable(least)
    steps = np.diff(samples.time)
    if np.ptp(steps) > UNEVEN * steps.mean():
        worst = int(np.argmax(np.abs(steps - np.median(steps))))
        raise SamplingError(
            "delays need samples that are even in time",
            f"the step after {samples.time[worst]:.4g} s is {steps[worst]:.4g} s, the others {np.median(steps):.4g} s",
            "Fit to one contiguous part.",
        )
    size = np.sqrt(np.mean(samples.y**2, axis=0))
    size[size == 0] = 1.0
    count = len(samples) - delays + 1
    stacked = np.concatenate([samples.y[k : k + count].T / size[:, None] for k in range(delays)])
    # of some hundred rows: the singular value decomposition's left side
    values, axes = np.linalg.eigh(stacked @ stacked.T)
    most = min(rank, int(np.sum(values > SMALLEST * values[-1])))
    return Hankel(stacked, axes[:, ::-1][:, :most], size)


def _modes(stacked: NDArray[np.float64], time: NDArray[np.float64], plan: tuple[int, int, int]):
    rank, bags, seed = plan
    state = np.random.get_state()  # noqa: NPY002 PyDMD draws from numpy's global state
    np.random.seed(seed)  # noqa: NPY002
    try:
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")  # of iterations that reached their number, which is a setting here
            options = {"verbose": False, "maxiter": MOST_ITERATIONS}
            bagged = {"num_trials": bags, "trial_size": 0.6, "eig_constraints": {"stable"}, "varpro_opts_dict": options}
            fit = chapter3_library("pydmd").BOPDMD(
                svd_rank=rank, use_proj=False, **bagged
            )  # they are projected already
            return fit.fit(stacked.astype(complex), time)
    except (np.linalg.LinAlgError, ValueError) as error:
        sought, remedy = "variable projection finds the modes of a record", "Take fewer modes, or filter the record."
        raise TrainingError(sought, f"PyDMD gave up: {error}", remedy) from error
    finally:
        np.random.set_state(state)  # noqa: NPY002


def fit_exact_dmd(samples: Samples, delays: int = DELAYS, rank: int = RANK) -> Dmd:
    """Fit modes to the outputs, which are stacked with their delays (Hankel matrix).

    Eigenvalues that are rounding are left out; what grows is held at its size, as in the other decompositions here.
    Amplitudes fit all columns, not the first alone.

    Source: Tu, Rowley, Luchtenburg, Brunton, Kutz 2014, J. Comput. Dyn. 1:391; Eqs. 2.5 to 2.9 of the dissertation.
        Under noise its eigenvalues are biased inwards (Dawson et al. 2016, Exp. Fluids 57:42).
    """
    hankel = delayed(samples, delays, rank)
    outputs, dt = len(hankel.size), float(samples.time[1] - samples.time[0])
    fit = chapter3_library("pydmd").DMD(svd_rank=hankel.axes.shape[1], exact=True, opt=True).fit(hankel.columns)
    kept = np.abs(fit.eigs) > SMALLEST_TURN
    found = np.log(np.asarray(fit.eigs[kept], np.complex128)) / dt
    continuous = np.asarray(np.minimum(found.real, 0.0) + 1j * found.imag, np.complex128)
    modes = (fit.modes[:outputs, kept] * hankel.size[:, None] * fit.amplitudes[kept]).T
    return Dmd((TIME,), samples.outputs, modes, continuous, float(samples.time[0]), np.zeros(len(found)))
