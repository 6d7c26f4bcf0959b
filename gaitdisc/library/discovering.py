"""What a model lacks against measured data."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.discover_files import find_missing
from gaitdisc.discovery.twins import refuse_twins
from gaitdisc.errors import LOG, SchemaError, SimulationError
from gaitdisc.library.simulating import ModelLike, as_model
from gaitdisc.recording import Recording
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.measured_table import gather_recordings, gather_table, read_measured
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import names_engine

if TYPE_CHECKING:
    import pandas as pd

    from gaitdisc.discovery.result import Discovery


def discover(
    model: ModelLike,
    data: Path | str | pd.DataFrame | Recording | Sequence[Recording] | Sequence[pd.DataFrame],
    catalogue: Path | str | None = None,
    progress: Callable[[str], None] | None = None,
    effects: Sequence[str] = (),
    alpha: float = 0.05,
    twins: int = 0,
) -> tuple[Discovery, Simulation]:
    """Identify the effect that a model lacks in comparison with measured trials, estimate it, and add it to the model.

    Part of the data is held out before any fit: entire trials if there are several, otherwise the last part of the
    trial. The reduction of the gap is reported on these data.

    Parameters
    ----------
    model : path, Simulation or callable
        A simulation file, the result of `read_simulation`, a Python function (`simulation_from_function`), or a model
        of MuJoCo or OpenSim or its mapping file (docs/engines.md).
    data : path, DataFrame, Recording, or sequence of Recording or of DataFrame
        Measured trials: one table (or its CSV or Parquet file), one table per trial, or one Recording per trial. A
        table has the columns `time` [s], each input and each observed channel in the model's units, and `trial` if it
        contains several trials. Units of a Recording are converted to those of the model.
    catalogue : path, optional
        A file of your own effects, in addition to the included ones.
    progress : callable, optional
        Function that receives one line about each step, such as `print`. By default the lines go to the logger
        `gaitdisc`.
    effects : sequence of str, optional
        Fit exactly these effects without a search, each ``"effect@place"`` (``"viscous_damping@air"``); held-out data
        support or refute them together.
    alpha : float, optional
        Maximum false-positive rate: the p-value of an identified effect on held-out data is below alpha. For a tracked
        walk, alpha is 0.05.
    twins : int, optional
        Number of records like yours to simulate with the identified effect, and the same number without it. All are
        searched in the same way; `found.twins` has the answers. Not available for models of MuJoCo and OpenSim.

    Returns
    -------
    found : Discovery
        Verdict, summary in one sentence, effects with intervals, other explanations, and the gap of both models.
    augmented : Simulation
        The model with the identified effect, for `simulate`; for a MuJoCo or OpenSim model, its mapping.

    Raises
    ------
    GaitdiscError
        If a file cannot be read, a column is missing, trials are too short or uneven, the initial model diverges,
        `effects` names an unknown effect or place, or `alpha` does not lie between 0 and 1.

    References
    ----------
    docs/discover.md describes the method: multiple shooting, and a ranking of effects by their held-out prediction
    error.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> found, augmented = gd.discover("ankle.toml", "walks.csv")  # doctest: +SKIP
    >>> print(found.sentence)  # doctest: +SKIP
    """
    request = Request.read(
        None if catalogue is None else Path(catalogue), tuple(effects), alpha, progress or LOG.info, twins
    )
    if isinstance(model, Path | str) and names_engine(model):
        if twins:
            refuse_twins(Path(model).name)
        return _of_engine(Path(model), data, request)
    simulation = as_model(model)
    measured, files = _measure(data, simulation)
    if isinstance(model, Path | str):
        files[Path(model)] = "simulation"
    if isinstance(simulation, PythonSimulation) and simulation.manner:
        request.progress(simulation.manner)
    return find_missing(simulation, measured, request, files)


def _of_engine(model: Path, data: Any, request: Request) -> tuple[Discovery, Simulation]:
    from gaitdisc.discovery.discover_engine import discover_engine, discover_model_file
    from gaitdisc.engines.tracked_mapping import read_tracked

    walk = read_tracked(model)
    if walk is not None:
        if not isinstance(data, Path | str):
            raise SchemaError(
                f"the walk of {model.name} must be given as a file of its angles (.mot, .sto)",
                f"found {type(data).__name__}",
                "Give the path of that file.",
            )
        from gaitdisc.discovery.discover_tracked import discover_tracked

        answered = discover_tracked(walk, Path(data), request)
        return answered.found, answered.augmented

    if isinstance(data, Path | str):
        answer = discover_model_file(model, Path(data), request)
    else:
        answer = discover_engine(model, lambda mapping: _measure(data, mapping)[0], request, {})
    return answer.found, answer.augmented


def _measure(data: object, simulation: Simulation) -> tuple[Measured, dict[Path, str]]:
    if isinstance(data, Path | str):
        return read_measured(data, simulation), {Path(data): "measured table"}
    several: Any = data if isinstance(data, list | tuple) else [data]
    if several and all(isinstance(entry, Recording) for entry in several):
        return gather_recordings(several, simulation), {}
    import pandas as pd

    if isinstance(data, list | tuple) and data and all(isinstance(table, pd.DataFrame) for table in data):
        trials = [_times(table).assign(trial=number) for number, table in enumerate(data, 1)]
        return gather_table(pd.concat(trials), simulation, "the table"), {}
    if isinstance(data, pd.DataFrame):
        return gather_table(_times(data), simulation, "the table"), {}
    raise SimulationError(
        "measured data must be a table, a file or recordings",
        f"found {type(data).__name__}",
        "Give a DataFrame with a column 'time' [s], the path of a CSV or Parquet file, or one Recording per trial.",
    )


def _times(table: pd.DataFrame) -> pd.DataFrame:
    return table.reset_index() if "time" not in table and table.index.name == "time" else table
