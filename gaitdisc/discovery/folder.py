"""A discovery on disk: `discovery.json`, the contract's keys first, then hashes; and the held-out runs as CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitdisc.discovery.result import (
    SIZES,
    ConditionAnswer,
    Correction,
    Discovery,
    Estimate,
    Explanation,
    FoundEffect,
    GapSize,
    Runs,
    Twins,
    Whereabouts,
)
from gaitdisc.saved.kind import Kind
from gaitdisc.saved.provenance import Provenance
from gaitdisc.saved.unit_folder import check_files, damage, file_sha256, of_another_format, read_sealed, seal_text
from gaitdisc.spreadsheet import read_csv, write_csv
from gaitdisc.whole_file import find_written, write_together, write_whole

if TYPE_CHECKING:
    import pandas as pd

NAME = "discovery.json"
RUNS = "held_out.csv"
FORMAT = 1


@write_together()
def save_discovery(discovery: Discovery, folder: Path, models: Sequence[str] = ()) -> Path:
    """Save a discovery; models: files of the augmented model, which were written into the folder together with it."""
    discovery = discovery.public
    write_csv(discovery.to_frame().dropna(), folder / RUNS, "%.8g")
    hashes = {name: file_sha256(find_written(folder / name)) for name in (RUNS, *models)}
    return write_whole(folder / NAME, seal_text({**discovery.to_json(), "format": FORMAT, "sha256": hashes}))


def load_discovery(folder: Path) -> Discovery:
    """Load a discovery; the runs have the eight digits of their table, and those samples that were measured."""
    from gaitdisc.saved.unit_folder import load_finding  # brings jsonschema, which saving does not need

    data = read_sealed(folder / NAME)
    if data.get("format", FORMAT) != FORMAT:  # before there was a number, the form was this one
        raise of_another_format(folder / NAME, data["format"], FORMAT)
    try:
        check_files(folder, data["sha256"])
        table = read_csv(folder / RUNS, ("trial",))
        channels = tuple(data["channels"])
        made = data["provenance"]
        return Discovery(
            verdict=data["verdict"],
            sentence=data["sentence"],
            where=tuple(
                Whereabouts(kind, place, **_restore(dict(others)))
                for (kind, place), *others in (row.items() for row in data["where"])
            ),
            effects=tuple(map(_effect, data["effects"])),
            rivals=tuple(map(_effect, data["rivals"])),
            train=_gap(data["gap"]["train"]),
            held_out=_gap(data["gap"]["held_out"]),
            channels=channels,
            units=tuple(data["channels"].values()),
            runs=_runs(table, channels),
            findings=tuple(map(load_finding, data["findings"])),
            provenance=Provenance(**made) if made else None,
            corrections=tuple(
                Correction(row["parameter"], given, Estimate(value, low, high, row["unit"]))
                for row in data["corrections"]
                for given, value, low, high in [map(_restore, (row[name] for name in ("from", "to", "low", "high")))]
            ),
            explanations=tuple(
                Explanation((*map(_effect, row["effects"]),), row["held_out"] and _gap(row["held_out"]), time, left)
                for row in data.get("explanations", ())
                for time, left in [map(_restore, (row["left"][name] for name in ("time", "measured_minus_run")))]
            ),
            given=data.get("given", ""),
            twins=Twins(**data["twins"]) if "twins" in data else None,
            beside=_restore(data.get("beside", {})),
            conditions=tuple(
                ConditionAnswer(
                    **row | {"effects": tuple(map(_effect, row["effects"])), "beside": _restore(row["beside"])}
                )
                for row in data.get("conditions", ())
            ),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        if hasattr(error, "needed"):  # a refusal of its own
            raise
        raise damage(folder / NAME, f"does not have the expected form ({type(error).__name__}: {error})") from error


def _restore(value: Any) -> Any:
    """Return what JSON held as results hold it: tuples, and NaN where a number was not finite."""
    if isinstance(value, Mapping):
        return {key: _restore(item) for key, item in value.items()}
    if isinstance(value, list):
        return tuple(_restore(item) for item in value)
    return float("nan") if value is None else value


def _effect(row: Mapping[str, Any]) -> FoundEffect:
    kind, place = next(iter(row.items()))  # they stand first
    bounds = zip(row.get("bounds", ()), (-np.inf, np.inf), strict=False)
    reading = row.get("reads_as", {"expression": "", "effect": None})
    return FoundEffect(
        kind,
        place,
        row["name"],
        row["term"],
        {name: Estimate(**_restore(estimate)) for name, estimate in row["estimates"].items()},
        **_restore(row["evidence"]),
        bounds=tuple(edge if bound is None else bound for bound, edge in bounds),
        reads_as=reading["expression"],
        reads_as_effect=reading["effect"] or "",
        **{name: row[name] for name in ("tied", "small", "states") if name in row},
    )


def _gap(row: Mapping[str, Any]) -> GapSize:
    size = _restore({key: value for key, value in row.items() if key != "unexplained"})
    channels = {name: tuple(errors[key] for key in SIZES) for name, errors in size["channels"].items()}
    return GapSize(**(size | {"channels": channels}))


def _runs(table: pd.DataFrame, channels: tuple[str, ...]) -> Runs:
    """Runs of the table side by side; NaN where a shorter one ends."""
    runs, place = np.unique(table["run"].to_numpy(), return_inverse=True)
    sample = table.groupby("run").cumcount().to_numpy()
    samples = int(sample.max()) + 1 if len(table) else 0

    def spread(values: np.ndarray) -> np.ndarray:
        padded = np.full((len(runs), samples, *values.shape[1:]), np.nan)
        padded[place, sample] = values
        return padded

    named = table["trial"].astype(str)
    trials = named.groupby(table["run"].to_numpy()).first().to_numpy(object)
    names = tuple(dict.fromkeys(named))
    measured, simulated, augmented = (
        spread(table[[f"{channel}_{word}" for channel in channels]].to_numpy(float))
        for word in ("measured", "simulated", "augmented")
    )
    return Runs(
        np.array([names.index(name) for name in trials], np.intp),
        spread(table["time"].to_numpy(float)),
        spread(table["phase"].to_numpy(float)) if "phase" in table else np.empty((0, 0)),
        measured,
        simulated,
        augmented,
        names=names,
    )


DISCOVERY = Kind(
    Discovery, NAME, write=save_discovery, read=load_discovery, page="gaitdisc.discovery.page:write_discovery_report"
)
