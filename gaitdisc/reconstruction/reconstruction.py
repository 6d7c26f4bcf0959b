"""The result of a reconstruction: errors of every model, state and participant, and curves over the stride."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.saved.kind import CSV, Kind, Saved
from gaitdisc.saved.provenance import Provenance, Refusal
from gaitdisc.words import as_html

NEAR = 1.02  # of the least error on the check part: a cheaper model that is within this is recommended instead
WORTH = 0.1  # of the root mean squared error, which one more sensor must take off
CALIBRATED = "{}, calibrated"  # name of a model that is corrected for the test person
CHEAP_FIRST = (
    "linear", "delay ridge", "shallow decoder", "fourier ridge", "shred",
    "masked shred", "shred ensemble", "shred-text",
)  # fmt: skip
FLOORS = ("persistence", "phase average")  # what a forecast has to beat; no models
MEASURES = ("rmse_deg", "relative_l2", "r2", "relative_l2_whole", "check_loss", "coverage", "seconds")


@dataclass(frozen=True, eq=False)
class Reconstruction(Saved, file="reconstruction.json"):
    """The content of a reconstruction report.

    Parameters
    ----------
    title : str
        Title of the study.
    sensors, states : tuple of Channel
        Sensors and reconstructed states.
    split : str
        The rule that splits the windows, in words.
    history : str
        Length and spacing of the windows, in words.
    models : mapping of str to str
        Name of each model -> its description.
    errors : DataFrame
        Columns participant, model, state, unit, rmse, low, high, relative_l2, r2.
    summary : DataFrame
        Columns participant, model, strides, n_fitted, and `MEASURES`.
    curves : DataFrame
        Columns participant, model, state, percent, measured, measured_sd, reconstructed, rmse.
    refusals : tuple of Refusal
        Persons and walks left out, with reasons.
    findings : tuple of Finding
        Findings in the recordings.
    provenance : Provenance
        Settings, seed, files, versions.
    search : DataFrame, optional
        Best set of sensors of every size, after a search; columns sensors, names, loss, rmse_deg, fits, seconds.
    """

    title: str
    sensors: tuple[Channel, ...]
    states: tuple[Channel, ...]
    split: str
    history: str
    models: Mapping[str, str]
    errors: pd.DataFrame
    summary: pd.DataFrame
    curves: pd.DataFrame
    refusals: tuple[Refusal, ...]
    findings: tuple[Finding, ...]
    provenance: Provenance
    search: pd.DataFrame | None = None

    @property
    def participants(self) -> tuple[str, ...]:
        """Pseudonyms of the participants, in the order of the tables."""
        return tuple(dict.fromkeys(str(name) for name in self.summary["participant"]))

    @property
    def recommended(self) -> str:
        """Recommended model: the cheapest one to fit with a validation error within 2 % of the smallest.

        The test part is not used. A calibrated model is recommended by its error before calibration; the baselines of a
        forecast are never recommended. `gaitdisc reconstruct` saves a model of this kind for every participant.
        """
        every = self.summary.groupby("model")["check_loss"].mean()
        loss = every[[kind for kind in CHEAP_FIRST if kind in every.index]]
        return str(loss.index[np.sqrt(loss / loss.min()) <= NEAR][0])

    def over_participants(self) -> pd.DataFrame:
        """Mean of each measure over participants, by model, with a 95 % CI (Student's t; for 3 or more)."""
        means: dict[object, dict[str, float]] = {}
        for model, rows in self.summary.groupby("model", sort=False):
            means[model] = {"n": len(rows)}
            for measure in MEASURES:
                mean, _, half = mean_over_people(rows[measure].to_numpy(float))
                means[model] |= {measure: mean, f"{measure}_low": mean - half, f"{measure}_high": mean + half}
        return pd.DataFrame(means).T

    def over_states(self) -> pd.DataFrame:
        """Mean RMSE, relative L2 and R2 over participants; indexed by state and model."""
        return self.errors.groupby(["state", "model"], sort=False)[["rmse", "relative_l2", "r2"]].mean()

    def to_frame(self) -> pd.DataFrame:
        """Errors of every participant, model and state."""
        return self.errors

    def __repr__(self) -> str:
        return (
            f"Reconstruction({len(self.states)} states from {len(self.sensors)} sensors, "
            f"{len(self.participants)} participants, models: {', '.join(self.models)})"
        )

    def _repr_html_(self) -> str:
        rows = [
            ("sensors", ", ".join(channel.name for channel in self.sensors)),
            ("states", str(len(self.states))),
            ("participants", ", ".join(self.participants)),
            ("recommended model", self.recommended),
        ]
        return as_html(self.title or "Reconstruction", rows)


def mean_over_people(values: Values) -> tuple[float, float, float]:
    """Mean, standard deviation, half of Student's 95 % interval of (participant,); the latter two from three people.

    >>> [round(each, 3) for each in mean_over_people(np.array([1.0, 2.0, 3.0]))]
    [2.0, 1.0, 2.484]
    """
    from scipy.stats import t

    n, mean = len(values), float(values.mean())
    if n < 3:
        return mean, float("nan"), float("nan")
    sd = float(values.std(ddof=1))
    return mean, sd, float(t.ppf(0.975, n - 1)) * sd / float(np.sqrt(n))


def enough_sensors(search: pd.DataFrame) -> int:
    """Row of the smallest set of sensors in a `search` that one more improves by less than a tenth.

    >>> enough_sensors(pd.DataFrame({"loss": [1.0, 0.5, 0.49]}))
    1
    """
    root = np.sqrt(search["loss"].to_numpy(float))
    worth = root[1:] < (1 - WORTH) * root[:-1]
    return int(np.argmin(worth)) if not worth.all() else len(root) - 1


RECONSTRUCTION = Kind(
    Reconstruction,
    "reconstruction.json",
    ("title", "sensors", "states", "split", "history", "models", "recommended", "refusals", "findings", "provenance"),
    {
        "errors": CSV("errors.csv", ("participant", "model", "state", "unit", "rmse")),
        "summary": CSV("summary.csv", ("participant", "model", "strides", "check_loss")),
        "curves": CSV("curves.csv", ("participant", "model", "state", "percent", "measured", "measured_sd")),
        "search": CSV("search.csv", None),
    },
    keyed=False,
    words=("participant", "model", "state", "unit"),
    page="gaitdisc.reconstruction.page:write_reconstruction_report",
)
