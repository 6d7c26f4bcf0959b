"""A discovery on disk: `discovery.json`, the contract's keys first, then hashes; and the held-out runs as CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitdisc.results.discovery import (
    ALPHA,
    Correction,
    Discovery,
    Estimate,
    Explanation,
    FoundEffect,
    GapSize,
    Runs,
    Whereabouts,
)
from gaitdisc.results.kind import Kind
from gaitdisc.results.provenance import Provenance
from gaitdisc.results.unit_folder import check_files, damaged, file_sha256, of_another_format, read_sealed, sealed_text
from gaitdisc.spreadsheet import read_csv, write_csv
from gaitdisc.whole_file import write_whole, written_so_far, written_together

if TYPE_CHECKING:
    import pandas as pd

NAME = "discovery.json"
RUNS = "held_out.csv"
FORMAT = 1


@written_together()
def save_discovery(discovery: Discovery, folder: Path, models: Sequence[str] = ()) -> Path:
    """Save a discovery; models: files of the augmented model, which were written into the folder together with it."""
    import pandas as pd

    write_csv(pd.DataFrame(discovery.runs.table(discovery.channels)).dropna(), folder / RUNS, "%.8g")
    hashes = {name: file_sha256(written_so_far(folder / name)) for name in (RUNS, *models)}
    return write_whole(folder / NAME, sealed_text({**discovery.to_json(), "format": FORMAT, "sha256": hashes}))


def load_discovery(folder: Path) -> Discovery:
    """Load a discovery; the runs have the eight digits of their table, and those samples that were measured."""
    from gaitdisc.results.unit_folder import stored_finding  # brings jsonschema, which saving does not need

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
            where=tuple(map(_where, data["where"])),
            effects=tuple(map(_effect, data["effects"])),
            rivals=tuple(map(_effect, data["rivals"])),
            train=_gap(data["gap"]["train"]),
            held_out=_gap(data["gap"]["held_out"]),
            channels=channels,
            units=tuple(data["channels"].values()),
            runs=_runs(table, channels),
            findings=tuple(map(stored_finding, data["findings"])),
            provenance=Provenance(**made) if made else None,
            corrections=tuple(
                Correction(one["parameter"], _number(one["from"]), _estimate(one, "to")) for one in data["corrections"]
            ),
            explanations=tuple(map(_explanation, data.get("explanations", ()))),
            given=data.get("given", ""),
            beside={name: _number(one) for name, one in data.get("beside", {}).items()},
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        if hasattr(error, "needed"):  # a refusal of its own
            raise
        raise damaged(folder / NAME, f"not in the expected form ({type(error).__name__}: {error})") from error


def _number(value: float | None, absent: float = float("nan")) -> float:
    return absent if value is None else float(value)


def _estimate(row: Mapping[str, Any], value: str = "value") -> Estimate:
    return Estimate(_number(row[value]), _number(row["low"]), _number(row["high"]), row["unit"])


def _where(row: Mapping[str, Any]) -> Whereabouts:
    kind, place = next(iter(row.items()))  # they stand first
    phase = tuple(_number(share) for share in row["phase"])
    return Whereabouts(kind, place, _number(row["share_of_gap"]), phase, row["region"])


def _effect(row: Mapping[str, Any]) -> FoundEffect:
    bounds = tuple(_number(bound, edge) for bound, edge in zip(row.get("bounds", ()), (-np.inf, np.inf), strict=False))
    kind, place = next(iter(row.items()))
    reading = row.get("reads_as", {"expression": "", "effect": None})
    return FoundEffect(
        kind=kind,
        place=place,
        name=row["name"],
        term=row["term"],
        estimates={name: _estimate(each) for name, each in row["estimates"].items()},
        held_out=_number(row["evidence"]["held_out"]),
        bic=_number(row["evidence"]["bic"]),
        tied=row.get("tied", False),
        small=row.get("small", False),
        bounds=bounds,
        states=row.get("states", {}),
        reads_as=reading["expression"],
        reads_as_effect=reading["effect"] or "",
    )


def _explanation(row: Mapping[str, Any]) -> Explanation:
    time, left = (tuple(map(_number, row["left"][name])) for name in ("time", "measured_minus_run"))
    return Explanation(
        tuple(map(_effect, row["effects"])), _gap(row["held_out"]) if row["held_out"] else None, time, left
    )


def _gap(row: Mapping[str, Any]) -> GapSize:
    channels = {name: _sizes(size) for name, size in row["channels"].items()}
    p, alpha = _number(row["p"]), row.get("alpha", ALPHA)
    return GapSize(*_sizes(row), p=p, channels=channels, pieces=row["pieces"], of=row.get("of", ""), alpha=alpha)


def _sizes(row: Mapping[str, Any]) -> tuple[float, float, float]:
    return _number(row["before"]), _number(row["after"]), _number(row["noise_floor"])


def _runs(table: pd.DataFrame, channels: tuple[str, ...]) -> Runs:
    """Runs of the table side by side; NaN where a shorter one ends."""
    runs, place = np.unique(table["run"].to_numpy(), return_inverse=True)
    sample = table.groupby("run").cumcount().to_numpy()
    samples = int(sample.max()) + 1 if len(table) else 0

    def spread(values: np.ndarray) -> np.ndarray:
        whole = np.full((len(runs), samples, *values.shape[1:]), np.nan)
        whole[place, sample] = values
        return whole

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
        names,
    )


DISCOVERY = Kind(
    Discovery,
    NAME,
    write=save_discovery,
    read=load_discovery,
    page="gaitdisc.report.discovery_page:write_discovery_report",
)
