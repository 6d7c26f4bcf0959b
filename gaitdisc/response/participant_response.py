"""What one participant's models say of held-out walks, and a study's: every participant, refusal and settings."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import SchemaError, ShapeError
from gaitdisc.model import Augmented, Model
from gaitdisc.processing.pooled_cycles import CYCLES, WALK, PooledCycles, WalkSummary
from gaitdisc.processing.samples import gait_samples
from gaitdisc.recording import PERCENT, Recording, Trial
from gaitdisc.response.participants_result import OVER, TESTS, OverParticipants, PairTests, table_of_people
from gaitdisc.saved.kind import CSV, Kind, pick_arrays
from gaitdisc.saved.study_run import StudyRun, load_run_as, save_whole_run
from gaitdisc.saved.unit_folder import Arrays, lies_on_disk, may_lie_on_disk
from gaitdisc.words import as_html

PROCESSING = ("filters", "strides", "treadmill", "models", "quality", "conditions")  # settings of a processed walk
QUESTIONS = ("modalities", "sensitivity")  # answered in folders beside a run
MODELS = ("nominal", "augmented", "exo")
BASELINES = ("ridge", "linear", "null")
R2_COLUMNS = ("variable", "model", "kind", "walk", "r2", "n")
FIT_COLUMNS = ("model", "kind", "decay", "epochs", "n_training", "n_inner")
QUANTITY_COLUMNS = ("length_s", "n_training", *R2_COLUMNS)


@dataclass(frozen=True, eq=False)
class HeldOut:
    """The held-out part of the device walk, measured and predicted."""

    time: NDArray[np.float64]  # (sample,) [s], on the trial's clock
    phi: NDArray[np.float64]  # (sample,) [% stride], percent stride
    measured: NDArray[np.float64]  # (sample, output) [unit/s2], second derivatives of the measured variables
    # each (sample, output) [unit/s2], keys among `MODELS`: the networks' predictions
    predicted: Mapping[str, NDArray[np.float64]]
    # each (bound, sample, output) [unit/s2], keys among `MODELS`: lower and upper bound of 90 % around what the
    # networks predict; empty in older results
    bands: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)


@may_lie_on_disk("held_out", "residuals", "weights")
@dataclass(frozen=True, eq=False)
class ParticipantResponse:
    """Nominal, Exo, Discrepancy and Augmented for one participant (Eqs. 4.2-4.5), tested on held-out walking."""

    participant: str
    inputs: tuple[str, ...]  # names of what goes in
    outputs: tuple[str, ...]  # names of what is predicted
    units: tuple[str, ...]  # unit of each output, a second derivative
    # variable, model (of `MODELS`), kind (`network`; `ridge`, with harmonics of percent stride; `linear`,
    # ridge on the network's own inputs; `null`), walk (`nominal` or `exo`: the held-out walking that is predicted), r2,
    # n (samples)
    r2: pd.DataFrame
    fits: pd.DataFrame  # model (`nominal`, `exo`, `discrepancy`), kind, decay, epochs, n_training, n_inner
    # Held-out device walking with the networks' predictions; of a response that was loaded it is read each time it is
    # looked at, as are the residuals
    held_out: HeldOut
    # each (stride, phase, output) [unit/s2], measured minus predicted, every held-out stride of the device walk on 101
    # points; keys among `MODELS`
    residuals: Mapping[str, NDArray[np.float64]]
    held_out_s: float  # length of the held-out part [s]
    # scales and weights of the networks, as `nominal_x_mean`; empty in results of older versions
    weights: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check shapes once, before they are saved."""
        if lies_on_disk(self, "held_out"):
            return
        columns = {
            "units": len(self.units),
            "held_out.measured": self.held_out.measured.shape[1],
            **{f"held_out.predicted[{k}]": v.shape[1] for k, v in self.held_out.predicted.items()},
            **{f"held_out.bands[{k}]": v.shape[2] for k, v in self.held_out.bands.items()},
            **{f"residuals[{k}]": v.shape[2] for k, v in self.residuals.items()},
        }
        count = len(self.outputs)
        for name, width in columns.items():
            if width != count:
                raise ShapeError(
                    f"{name} of a response must have {count} columns, one per output",
                    f"it has {width} for {self.participant}",
                    "Give one column per output.",
                )
        for name, curves in self.residuals.items():
            if curves.shape[1] != len(PERCENT):
                raise ShapeError(
                    f"residuals must have {len(PERCENT)} points per stride",
                    f"residuals[{name}] of {self.participant} has {curves.shape[1]}",
                    "Normalise the strides to 0-100 %.",
                )

    def r2_of(self, variable: str, model: str, kind: str = "network", walk: str = "exo") -> float:
        """Coefficient of determination of one variable, one model, one held-out walk; NaN where it was not computed."""
        return self._r2.get((variable, model, kind, walk), float("nan"))

    @cached_property
    def _r2(self) -> dict[Any, float]:
        return self.r2.set_index(["variable", "model", "kind", "walk"])["r2"].astype(float).to_dict()

    def model(self, name: str) -> Model:
        """Fitted network `nominal`, `exo` or `discrepancy`, or `augmented`, the sum of the first and the last."""
        if name == "augmented":
            return Augmented(self.model("nominal"), self.model("discrepancy"))
        arrays = pick_arrays(self.weights, f"{name}_")
        if not arrays:
            raise SchemaError(
                "a model of a prediction must be `nominal`, `exo`, `discrepancy` or `augmented`, with its weights",
                f"the response of {self.participant} has no weights of {name!r}",
                "Choose one of these, or fit again a response that an older version saved without weights.",
            )
        from gaitdisc.models.networks import FeedForward
        from gaitdisc.models.trained_network import restore_network

        return restore_network(self.inputs, self.outputs, arrays, FeedForward(len(self.inputs), len(self.outputs)))


@dataclass(frozen=True, eq=False)
class DataQuantity:
    """R2 on the same held-out walking for every length of the training part."""

    participant: str
    part: str  # `first` or `last`: which seconds of the training part are taken
    # length_s [s], n_training (samples of the device walk), and the columns of `ParticipantResponse.r2`
    table: pd.DataFrame
    # length [s] -> why there is no row of it: longer than the training part, or too short to fit
    left_away: Mapping[float, str]

    def medians(self, walk: str = "exo", kind: str = "network") -> pd.DataFrame:
        """Median R2 over variables: one row a length, one column a model."""
        chosen = self.table[(self.table["walk"] == walk) & (self.table["kind"] == kind)]
        return chosen.pivot_table(index="length_s", columns="model", values="r2", aggfunc="median")


def _find_held_out(arrays: Arrays) -> HeldOut:
    predicted, bands = pick_arrays(arrays, "predicted_"), pick_arrays(arrays, "band_")
    return HeldOut(arrays["time"], arrays["phi"], arrays["measured"], predicted, bands)


def _predict(response: ParticipantResponse) -> dict[str, NDArray[np.float64]]:
    held = response.held_out
    every = {"predicted": held.predicted, "band": held.bands, "residual": response.residuals}
    every["weights"] = response.weights
    by_model = {f"{word}_{model}": values for word, of in every.items() for model, values in of.items()}
    return {"time": held.time, "phi": held.phi, "measured": held.measured, **by_model}


RESPONSE = Kind(
    ParticipantResponse,
    "response.json",
    ("participant", "inputs", "outputs", "units", "held_out_s"),
    {"r2": CSV("r2.csv", R2_COLUMNS), "fits": CSV("fits.csv", FIT_COLUMNS)},
    {
        "residuals": partial(pick_arrays, prefix="residual_"),
        "weights": partial(pick_arrays, prefix="weights_"),
        "held_out": _find_held_out,
    },
    _predict,
    unit=lambda response: response.participant,
)
QUANTITY = Kind(
    DataQuantity,
    "quantity.json",
    ("participant", "part", "left_away"),
    {"table": CSV("quantity.csv", QUANTITY_COLUMNS)},
    reasons="length_s",
    unit=lambda quantity: quantity.participant,
)


@dataclass(frozen=True, eq=False, repr=False)
class ResponseRun(StudyRun):
    """The content of a response report; drawing it needs no new fit.

    Parameters
    ----------
    title : str
        Title of the study.
    nominal, exo : str
        The study's names of the two conditions; `exo` is empty if no device is compared.
    refusals : tuple of Refusal
        Persons and walks left out, with reasons.
    provenance : Provenance
        Settings, seed, files, versions.
    units : mapping of str to tuple
        Saved parts of the result, by name: `walks`, `responses`, `tests`, `quantities`, `over`, `cycles`.
    unfitted : tuple of Refusal
        In a study with a device: participants with pooled cycles but without fitted models, with reasons.
    renewed : tuple of str
        Files of an earlier run that were changed or unreadable and were computed again; not saved.
    """

    @property
    def walks(self) -> tuple[WalkSummary, ...]:
        """Summary of every walk that could be processed."""
        return self.of(WALK)

    @property
    def responses(self) -> tuple[ParticipantResponse, ...]:
        """Results of every participant whose models could be fitted."""
        return self.of(RESPONSE)

    @property
    def tests(self) -> PairTests | None:
        """Paired comparisons of the models over participants; None in runs of older versions."""
        return next(iter(self.of(TESTS)), None)

    @property
    def quantities(self) -> tuple[DataQuantity, ...]:
        """Results with less training data, if `gaitdisc ablate` was run."""
        return self.of(QUANTITY)

    @property
    def over(self) -> OverParticipants | None:
        """Training lengths, residuals, baselines and sub-groups, over participants; None in runs of older versions."""
        return next(iter(self.of(OVER)), None)

    @property
    def cycles(self) -> tuple[PooledCycles, ...]:
        """Pooled cycles of each participant, session and condition."""
        return self.of(CYCLES)

    @property
    def reported(self) -> tuple[str, ...]:
        """Participants with reported models or cycles."""
        names = [response.participant for response in self.responses]
        return tuple(dict.fromkeys([*names, *(pooled.subject for pooled in self.cycles if len(pooled.kept))]))

    def predict(self, walk: Trial, model: str = "augmented", participant: str = "") -> Recording:
        """Predict second derivatives along another walk, which is processed with the settings of this run.

        Parameters
        ----------
        walk : Trial
            A walk with the inputs of the model, as `gaitdisc.read` returns it.
        model : str
            `nominal`, `exo`, `discrepancy` or `augmented`.
        participant : str
            Participant whose model predicts; may be omitted if the run has only one.

        Returns
        -------
        Recording
            Second derivatives of the outputs [unit/s2], as from `differentiate`; NaN where an input is missing.

        Raises
        ------
        SchemaError
            If the run has no such participant or model, or if an older version saved it without weights.
        """
        from gaitdisc.ingest.study import Study
        from gaitdisc.processing.process import processed

        responses = [response for response in self.responses if participant in ("", response.participant)]
        if len(responses) != 1:
            defect = f"found {participant!r}; the run has {', '.join(self.reported) or 'none'}"
            raise SchemaError("a prediction must name one participant of the run", defect, "Name one of them.")
        response, settings = responses[0], self.provenance.settings
        chosen = {key: settings[key] for key in PROCESSING if key in settings}
        study = Study.model_validate_json(json.dumps({**chosen, "participants": [{"id": response.participant}]}))
        trajectory = processed(walk, study).trajectory
        samples, _ = gait_samples(trajectory, response.outputs)
        values = np.full((len(trajectory.time), len(response.outputs)), np.nan)
        values[np.searchsorted(trajectory.time, samples.time)] = response.model(model)(samples.x)
        measured = (trajectory.channels[column] for column in trajectory.columns(response.outputs))
        channels = tuple(replace(channel, unit=unit) for channel, unit in zip(measured, response.units, strict=True))
        return Recording(trajectory.time, values, channels, walk.subject, walk.condition)

    def to_frame(self) -> pd.DataFrame:
        """R2 of every participant, variable, model, kind and walk, one row each."""
        return table_of_people(self.responses, "r2", R2_COLUMNS)

    r2_table = to_frame

    def __repr__(self) -> str:
        counts = f"{len(self.responses)} responses, {len(self.cycles)} sets of cycles, {len(self.refusals)} refusals"
        return f"ResponseRun({self.title!r}, {counts})"

    def _repr_html_(self) -> str:
        rows = [("conditions", " and ".join(word for word in (self.nominal, self.exo) if word))]
        rows += [("participants", ", ".join(self.reported)), ("refusals", str(len(self.refusals)))]
        table = self.r2_table()
        table = table[(table["kind"] == "network") & (table["walk"] == "exo")]
        middle = table.groupby("model", sort=False)["r2"].median()
        rows += [(f"median R² of {model}", f"{value:.2f}") for model, value in middle.items()]
        return as_html(self.title or "Response run", rows)


def load_run(folder: Path) -> ResponseRun:
    """Load a run with all its units."""
    return load_run_as(ResponseRun, folder)


RUN = Kind(
    ResponseRun,
    "run.json",
    write=save_whole_run,
    read=load_run,
    page="gaitdisc.response.page:write_report",
    page_folder="report",
    beside=QUESTIONS,
)
