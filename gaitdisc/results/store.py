"""Saving and loading of results: JSON for what is named, CSV for tables, NPZ for arrays; every file hashed.

A run is a folder::

    run.json                       title, conditions, refusals, provenance, which units there are
    walks/<person>-<condition>/    walk.json  strides.csv  arrays.npz
    responses/<person>/            response.json  r2.csv  fits.csv  arrays.npz

A unit (one walk, one response) is complete when its JSON file stands, because that is written last and holds the hashes
of the others. A damaged unit is told by its hash and computed again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jsonschema import Draft202012Validator
from numpy.typing import NDArray

from gaitdisc.channel import Channel, schema_folder
from gaitdisc.errors import SchemaError
from gaitdisc.recording import Finding
from gaitdisc.results.participant_response import HeldOut, ParticipantResponse
from gaitdisc.results.provenance import Provenance
from gaitdisc.results.response_run import Refusal, ResponseRun
from gaitdisc.results.walk_summary import WalkSummary
from gaitdisc.whole_file import whole_file

FORMAT = 1


def save_walk(walk: WalkSummary, folder: Path, key: str) -> None:
    """Save one walk.

    Parameters
    ----------
    walk : WalkSummary
        What to keep.
    folder : Path
        Folder of this walk alone.
    key : str
        What the walk was computed from: a hash of files and settings.
    """
    _save_unit(
        folder,
        "walk.json",
        {
            "key": key,
            "subject": walk.subject,
            "condition": walk.condition,
            "duration_s": walk.duration_s,
            "rate_hz": walk.rate_hz,
            "detector": walk.detector,
            "channels": [asdict(channel) for channel in walk.channels],
            "findings": [asdict(finding) for finding in walk.findings],
            "files": dict(walk.files),
        },
        {"strides.csv": walk.strides},
        {"curves": walk.curves},
    )


def load_walk(folder: Path) -> tuple[WalkSummary, str]:
    """Load one walk, and the key it was computed from.

    Parameters
    ----------
    folder : Path
        Folder that `save_walk` wrote.

    Raises
    ------
    SchemaError
        If a file is missing, damaged or of another format.
    """
    data, tables, arrays = _load_unit(folder, "walk.json")
    strides = tables["strides.csv"]
    strides["reason"] = strides["reason"].fillna("").astype(str)
    findings = tuple(Finding(**{**f, "spans": tuple(tuple(span) for span in f["spans"])}) for f in data["findings"])
    walk = WalkSummary(
        data["subject"],
        data["condition"],
        data["duration_s"],
        data["rate_hz"],
        data["detector"],
        tuple(Channel(**channel) for channel in data["channels"]),
        arrays["curves"],
        strides,
        findings,
        data["files"],
    )
    return walk, data["key"]


def save_response(response: ParticipantResponse, folder: Path, key: str) -> None:
    """Save the response of one participant.

    Parameters
    ----------
    response : ParticipantResponse
        What to keep.
    folder : Path
        Folder of this participant alone.
    key : str
        What it was computed from: a hash of files and settings.
    """
    held = response.held_out
    _save_unit(
        folder,
        "response.json",
        {
            "key": key,
            "participant": response.participant,
            "inputs": list(response.inputs),
            "outputs": list(response.outputs),
            "units": list(response.units),
            "held_out_s": response.held_out_s,
        },
        {"r2.csv": response.r2, "fits.csv": response.fits},
        {
            "time": held.time,
            "phi": held.phi,
            "measured": held.measured,
            **{f"predicted_{model}": values for model, values in held.predicted.items()},
            **{f"residual_{model}": values for model, values in response.residuals.items()},
        },
    )


def load_response(folder: Path) -> tuple[ParticipantResponse, str]:
    """Load the response of one participant, and the key it was computed from.

    Parameters
    ----------
    folder : Path
        Folder that `save_response` wrote.

    Raises
    ------
    SchemaError
        If a file is missing, damaged or of another format.
    """
    data, tables, arrays = _load_unit(folder, "response.json")
    response = ParticipantResponse(
        data["participant"],
        tuple(data["inputs"]),
        tuple(data["outputs"]),
        tuple(data["units"]),
        tables["r2.csv"],
        tables["fits.csv"],
        HeldOut(arrays["time"], arrays["phi"], arrays["measured"], _keyed(arrays, "predicted_")),
        _keyed(arrays, "residual_"),
        data["held_out_s"],
    )
    return response, data["key"]


def save_run(run: ResponseRun, folder: Path) -> None:
    """Save what a run is, beside the units that were saved as they were computed.

    Parameters
    ----------
    run : ResponseRun
        The whole result.
    folder : Path
        Folder of the run.
    """
    data = {
        "format": FORMAT,
        "title": run.title,
        "conditions": {"nominal": run.nominal, "exo": run.exo},
        "walks": [unit_name(walk.subject, walk.condition) for walk in run.walks],
        "responses": [response.participant for response in run.responses],
        "refusals": [asdict(refusal) for refusal in run.refusals],
        "provenance": asdict(run.provenance),
    }
    with whole_file(folder / "run.json") as part:
        part.write_text(_json(data), encoding="utf-8")


def load_run(folder: Path) -> ResponseRun:
    """Load a run with all its units.

    Parameters
    ----------
    folder : Path
        Folder that `gaitdisc run` wrote.

    Raises
    ------
    SchemaError
        If the folder holds no finished run, or a unit of it is missing or damaged.
    """
    data = _read_json(folder / "run.json")
    return ResponseRun(
        data["title"],
        data["conditions"]["nominal"],
        data["conditions"]["exo"],
        tuple(load_walk(folder / "walks" / name)[0] for name in data["walks"]),
        tuple(load_response(folder / "responses" / name)[0] for name in data["responses"]),
        tuple(Refusal(**refusal) for refusal in data["refusals"]),
        Provenance(**data["provenance"]),
    )


def unit_name(subject: str, condition: str) -> str:
    """Folder name of a walk: letters, digits, `-` and `_` only.

    Parameters
    ----------
    subject, condition : str
        Pseudonym and condition.

    Examples
    --------
    >>> unit_name("P01", "no spring")
    'P01-no_spring'
    """
    text = f"{subject}-{condition}"
    return "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in text)


def _save_unit(
    folder: Path,
    name: str,
    data: Mapping[str, Any],
    tables: Mapping[str, pd.DataFrame],
    arrays: Mapping[str, NDArray[np.float64]],
) -> None:
    for file, table in tables.items():
        with whole_file(folder / file) as part:
            table.to_csv(part, index=False, lineterminator="\n")
    with whole_file(folder / "arrays.npz") as part, part.open("wb") as stream:
        np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
    hashes = {file: _sha256(folder / file) for file in (*tables, "arrays.npz")}
    with whole_file(folder / name) as part:
        part.write_text(_json({"format": FORMAT, **data, "sha256": hashes}), encoding="utf-8")


def _load_unit(
    folder: Path, name: str
) -> tuple[dict[str, Any], dict[str, pd.DataFrame], dict[str, NDArray[np.float64]]]:
    data = _read_json(folder / name)
    for file, wanted in data["sha256"].items():
        path = folder / file
        if not path.is_file() or _sha256(path) != wanted:
            raise _damaged(path, "missing" if not path.is_file() else "changed since it was saved (SHA-256 differs)")
    tables = {file: pd.read_csv(folder / file, engine="python") for file in data["sha256"] if file.endswith(".csv")}
    with np.load(folder / "arrays.npz") as stored:
        arrays = {key: stored[key] for key in stored.files}
    return data, tables, arrays


def _read_json(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise _damaged(path, "missing") from None
    except (OSError, ValueError) as error:
        raise _damaged(path, f"not readable as JSON ({error})") from error
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise _damaged(path, f"of format {data.get('format') if isinstance(data, dict) else None!r}, not {FORMAT}")
    wrong = next(iter(_validator(path.stem).iter_errors(data)), None)
    if wrong is not None:
        raise _damaged(path, f"not of the agreed form at {wrong.json_path}: {wrong.message[:200]}")
    return data


@cache
def _validator(part: str) -> Draft202012Validator:
    schema = json.loads((schema_folder() / "results.schema.json").read_text(encoding="utf-8"))
    return Draft202012Validator({"$ref": f"#/$defs/{part}", "$defs": schema["$defs"]})


def _damaged(path: Path, what: str) -> SchemaError:
    return SchemaError(
        "results need every file of their folder as it was saved",
        f"{path.parent.name}/{path.name} is {what}",
        "Run `gaitdisc run` on the study again: what is whole is kept, the rest is computed anew.",
    )


def _keyed(arrays: Mapping[str, NDArray[np.float64]], prefix: str) -> dict[str, NDArray[np.float64]]:
    return {key.removeprefix(prefix): values for key, values in arrays.items() if key.startswith(prefix)}


def _json(data: Mapping[str, Any]) -> str:
    return json.dumps(data, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
