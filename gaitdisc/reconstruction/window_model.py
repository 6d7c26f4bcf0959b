"""Models that reconstruct the state from sensors: a network and, beside it, what a network has to beat."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from gaitdisc.channel import check_word
from gaitdisc.errors import ChannelError, TrainingError
from gaitdisc.model import Model
from gaitdisc.reconstruction.windows import Lags, cut_windows, hidden, present, thin_windows
from gaitdisc.recording import Recording, Samples, Scale
from gaitdisc.recording.arrays import Values

if TYPE_CHECKING:
    from gaitdisc.models.trained_network import TrainedNetwork

FEATURES = 1000
MOST_FITTED = 20_000  # windows; beyond it every k-th is fitted
KINDS = {
    "linear": "ridge regression on the current samples",
    "shallow decoder": "two hidden layers on the current samples (SDN)",
    "delay ridge": "ridge regression on the samples and their history",
    "fourier ridge": f"ridge regression on {FEATURES} random Fourier features of the samples and their history",
    "shred": "recurrent network on the samples and their history, with a shallow decoder (SHRED)",
}
MASKED = "masked shred"
ENSEMBLE, MEMBERS = "shred ensemble", 5
OF_TEXT, TEXT_STEPS, TEXT_PATIENCE = "shred-text", 4000, 1600  # steps of 64 windows; patience is 100 epochs of 1,000
ON_REQUEST = {
    MASKED: "SHRED with a mask of missing samples, trained with some samples hidden",
    ENSEMBLE: f"mean of {MEMBERS} SHRED networks with different seeds",
    OF_TEXT: "SHRED as in the dissertation's code: two LSTM layers of 64 units, decoder of 350 and 400, Adam at 0.001",
}
STATIC = ("linear", "shallow decoder")
WITHOUT_NETWORK = ("linear", "delay ridge", "fourier ridge")  # cheap: fitted many times where that is wanted
DEVICES = ("auto", "cpu", "cuda")


class ScaledModel(Model, Protocol):
    """A model that keeps the scales of its inputs and outputs in the training part."""

    @property
    def x_scale(self) -> Scale:
        """Of every input."""
        ...

    @property
    def y_scale(self) -> Scale:
        """Of every state."""
        ...


class OfOne:
    """A model with the names and scales of another one, its `model`."""

    model: ScaledModel

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, in order."""
        return self.model.inputs

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the states, in order."""
        return self.model.outputs

    @property
    def x_scale(self) -> Scale:
        """Of every input."""
        return self.model.x_scale

    @property
    def y_scale(self) -> Scale:
        """Of every state."""
        return self.model.y_scale


@dataclass(frozen=True, eq=False)
class Ensemble(OfOne):
    """Mean of networks that differ in their first weights and in the order of the samples.

    Source: Lakshminarayanan, Pritzel and Blundell 2017, Simple and scalable predictive uncertainty estimation using
        deep ensembles; without its variance head and adversarial training.
    """

    members: tuple[TrainedNetwork, ...]  # at least one; of the same inputs, outputs and scales

    @property
    def model(self) -> TrainedNetwork:  # type: ignore[override]
        """The first member."""
        return self.members[0]

    def __call__(self, x: Values) -> Values:
        """Mean states (window, state) for inputs (window, input)."""
        return np.mean([member(x) for member in self.members], axis=0)

    def spread(self, x: Values) -> Values:
        """Standard deviation among the members, (window, state) [each state's unit]: what all miss is not in it."""
        return np.std([member(x) for member in self.members], axis=0)


@dataclass(frozen=True)
class Sensing:
    """What is read, and what is to be reconstructed from it."""

    sensors: tuple[str, ...]
    states: tuple[str, ...]  # channels to reconstruct; none of them is a sensor, unless the future is forecast
    lags: Lags
    rate_hz: float

    @property
    def reach_s(self) -> float:
        """From the first reading of a window to the state that is reconstructed from it [s]."""
        return (self.lags.reach + self.lags.ahead) / self.rate_hz

    def windows(self, recording: Recording, phi: Values, missing: bool = False) -> Samples:
        """Windows of a recording of the same rate and units; phi (time,) [% stride]; missing readings if allowed."""
        return cut_windows(recording, self.sensors, self.states, self.lags, phi, missing)


def sensing(all_states: tuple[str, ...], sensors: tuple[str, ...], lags: Lags, rate_hz: float) -> Sensing:
    """Reconstruct every state that no sensor measures, or forecast every state; sensors may be among the states."""
    states = all_states if lags.ahead else tuple(name for name in all_states if name not in sensors)
    if not sensors or len(set(sensors)) < len(sensors):
        raise ChannelError(
            "a reconstruction must have at least one sensor, and each only once",
            f"found {', '.join(sensors) or 'none'}",
            "Name channels of the recording with --sensors.",
        )
    if not states:
        raise ChannelError(
            "a reconstruction must have at least one state that no sensor measures",
            f"{', '.join(all_states)} are all sensors",
            "Remove a sensor, or record more channels.",
        )
    return Sensing(sensors, states, lags, rate_hz)


@dataclass(frozen=True, eq=False)
class WindowModel:
    """A fitted model that reconstructs states from windows."""

    kind: str
    sensing: Sensing
    model: ScaledModel  # takes the present readings where the kind is without history, whole windows otherwise
    n_fitted: int
    seconds: float  # processor time of the fit [s]
    device: str = "cpu"  # where it was fitted: `cpu` or `cuda`

    @property
    def sensor_means(self) -> Values:
        """Mean reading of each sensor in the training part, (sensor,) [each sensor's unit]."""
        return self.model.x_scale.mean[-len(self.sensing.sensors) :]

    def __call__(self, windows: Samples) -> Values:
        """States (window, state) reconstructed from windows, each in its unit."""
        seen = present(windows, self.sensing.sensors) if self.kind in STATIC else windows
        return self.model(seen.x)


def fitting_device(kinds: Sequence[str], device: str) -> str:
    """`cpu` or `cuda` for kinds of models; `auto` is the GPU where there is one, ridge regression takes the CPU.

    >>> fitting_device(("delay ridge",), "auto")
    'cpu'
    """
    if device in DEVICES and all(kind in WITHOUT_NETWORK for kind in kinds):
        return "cpu"
    from gaitdisc.models.trainer import choose_device

    return choose_device(device).type


def fit_reconstructor(
    kind: str, what: Sensing, training: Samples, check: Samples, seed: int = 0, device: str = "auto"
) -> WindowModel:
    """Fit one kind of model; scales, penalties and the epoch whose weights stay are chosen without the test part.

    training, check: windows to fit, and windows to choose by; readings may be missing for `masked shred`
    device: that a network is fitted on: `cpu`, `cuda`, or `auto`, the GPU where there is one
    """
    check_word(kind, (*KINDS, *ON_REQUEST), "the kind of model")
    device = fitting_device((kind,), device)
    fit = _find_fit(kind, len(what.sensors), seed, device)
    training, check = thin_windows(training, MOST_FITTED), thin_windows(check, MOST_FITTED)
    if kind in STATIC:
        training, check = present(training, what.sensors), present(check, what.sensors)
    if kind == MASKED:
        training, check = hidden(training, len(what.sensors), seed), hidden(check, len(what.sensors), seed + 1)
    begun = time.process_time()
    model = fit(training, check)
    return WindowModel(kind, what, model, len(training), time.process_time() - begun, device)


def _find_fit(kind: str, sensors: int, seed: int, device: str) -> Callable[[Samples, Samples], ScaledModel]:
    from gaitdisc.models.fourier_ridge import fit_fourier_ridge

    if kind in ("linear", "delay ridge"):
        return fit_fourier_ridge
    if kind == "fourier ridge":
        return partial(fit_fourier_ridge, features=FEATURES, seed=seed)
    from gaitdisc.models.trainer import train
    from gaitdisc.models.training_settings import TrainingSettings

    build, missing = make_network(kind, sensors), kind == MASKED
    settings = TrainingSettings(epochs=20, batch=128, decays=(0.01,), seed=seed, device=device, missing_inputs=missing)
    if kind == OF_TEXT:
        text = TrainingSettings(
            batch=64, learning_rate=1e-3, falling=False, decays=(0.0,), solved=False, seed=seed, device=device
        )

        def fit(training: Samples, check: Samples) -> ScaledModel:
            steps = math.ceil(len(training) / text.batch)  # of an epoch
            long = replace(text, epochs=math.ceil(TEXT_STEPS / steps), patience=math.ceil(TEXT_PATIENCE / steps))
            return train(training, build, long, check=check).network

        return fit
    if kind == ENSEMBLE:
        members = [replace(settings, seed=seed + k) for k in range(MEMBERS)]
        return lambda training, check: Ensemble(tuple(train(training, build, s, check=check).network for s in members))
    return lambda training, check: train(training, build, settings, check=check).network


def make_network(kind: str, sensors: int) -> Callable[[int, int], Any]:
    """Return what makes the network of a kind, from its numbers of inputs and outputs."""
    from gaitdisc.models.networks import ShallowDecoder, Shred

    if kind == "shallow decoder":
        return ShallowDecoder
    if kind == OF_TEXT:
        return partial(Shred, sensors=sensors, layers=2, cell="lstm", first=350, second=400)
    return partial(Shred, sensors=sensors, masked=kind == MASKED)


def latent_states(done: WindowModel, windows: Samples) -> Values:
    """Latent state of a fitted SHRED at the last reading of each window, (window, node) [1]."""
    from gaitdisc.models.networks import Shred
    from gaitdisc.models.trained_network import TrainedNetwork

    model = done.model
    if not isinstance(model, TrainedNetwork) or not isinstance(model.network, Shred):
        raise TrainingError(
            "only a model with one recurrent network has a latent state",
            f"the model is {done.kind!r}",
            "Fit 'shred', 'masked shred' or 'shred-text'.",
        )
    return model.latent(windows.x)


def leading(values: Values, count: int = 3) -> Values:
    """Return the first principal components in time, each of standard deviation 1, (time, component) [1].

    The largest entry of each component's direction is positive, so that its sign does not rest on the decomposition.

    >>> t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    >>> found = leading(np.column_stack([3 * np.sin(t), np.cos(t)]), 2)
    >>> bool(np.allclose(found, np.sqrt(2) * np.column_stack([np.sin(t), np.cos(t)])))
    True
    """
    about = values - values.mean(axis=0)
    u, _, v = np.linalg.svd(about, full_matrices=False)
    signs = np.sign(v[np.arange(len(v)), np.argmax(np.abs(v), axis=1)])
    return (u * signs)[:, :count] * np.sqrt(len(values))
