"""Saving and loading of results: JSON for what is named, CSV for tables, NPZ for arrays; every file hashed.

A run is a folder::

    run.json                       title, conditions, refusals, provenance, which units there are
    walks/<person>-<condition>/    walk.json  strides.csv  arrays.npz
    responses/<person>/            response.json  r2.csv  fits.csv  arrays.npz
    refused/<person>/              refused.json
    tests/                         tests.json  tests.csv  families.csv
    over/                          over.json  lengths.csv  reductions.csv  reduction_tests.csv  ...
    quantities/<person>/           quantity.json  quantity.csv

A unit (one walk, one response) is complete when its JSON file stands, because that is written last and holds the hashes
of the others. A damaged unit is told by its hash and computed again.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.recording import Finding
from gaitdisc.results.comparison_store import load_over, load_tests, save_over, save_tests
from gaitdisc.results.data_quantity import DataQuantity
from gaitdisc.results.on_disk import Arrays
from gaitdisc.results.participant_response import HeldOut, ParticipantResponse
from gaitdisc.results.provenance import Provenance
from gaitdisc.results.response_run import Refusal, ResponseRun
from gaitdisc.results.unit_folder import FORMAT, json_text, load_unit, read_json, save_unit
from gaitdisc.results.walk_summary import WalkSummary
from gaitdisc.whole_file import whole_file


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
    save_unit(
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
    data, tables, arrays = load_unit(folder, "walk.json")
    strides = tables["strides.csv"]
    strides["reason"] = strides["reason"].astype(object).fillna("").astype(str)
    findings = tuple(Finding(**{**f, "spans": tuple(tuple(span) for span in f["spans"])}) for f in data["findings"])
    walk = WalkSummary(
        data["subject"],
        data["condition"],
        data["duration_s"],
        data["rate_hz"],
        data["detector"],
        tuple(Channel(**channel) for channel in data["channels"]),
        arrays.later(_curves),
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
    save_unit(
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
    data, tables, arrays = load_unit(folder, "response.json")
    response = ParticipantResponse(
        data["participant"],
        tuple(data["inputs"]),
        tuple(data["outputs"]),
        tuple(data["units"]),
        tables["r2.csv"],
        tables["fits.csv"],
        arrays.later(_held_out),
        arrays.later(_residuals),
        data["held_out_s"],
    )
    return response, data["key"]


def save_quantity(quantity: DataQuantity, folder: Path, key: str) -> None:
    """Save what less data would have given for one participant.

    Parameters
    ----------
    quantity : DataQuantity
        What to keep.
    folder : Path
        Folder of this participant alone.
    key : str
        What it was computed from: a hash of files and settings.
    """
    left_away = [{"length_s": length, "reason": reason} for length, reason in quantity.left_away.items()]
    data = {"key": key, "participant": quantity.participant, "part": quantity.part, "left_away": left_away}
    save_unit(folder, "quantity.json", data, {"quantity.csv": quantity.table}, {})


def load_quantity(folder: Path) -> tuple[DataQuantity, str]:
    """Load what less data would have given, and the key it was computed from.

    Parameters
    ----------
    folder : Path
        Folder that `save_quantity` wrote.

    Raises
    ------
    SchemaError
        If a file is missing, damaged or of another format.
    """
    data, tables, _ = load_unit(folder, "quantity.json")
    left_away = {float(row["length_s"]): str(row["reason"]) for row in data["left_away"]}
    return DataQuantity(data["participant"], data["part"], tables["quantity.csv"], left_away), data["key"]


def save_refused(refusals: tuple[Refusal, ...], walks: tuple[str, ...], folder: Path, key: str) -> None:
    """Save why a participant was refused, so that a run that goes on does not read and process the walks again.

    Parameters
    ----------
    refusals : tuple of Refusal
        In the words of the errors.
    walks : tuple of str
        Conditions whose walk could be processed all the same.
    folder : Path
        Folder of this participant alone.
    key : str
        What it was computed from: a hash of files and settings.
    """
    data = {"key": key, "refusals": [asdict(refusal) for refusal in refusals], "walks": list(walks)}
    save_unit(folder, "refused.json", data, {}, {})


def load_refused(folder: Path) -> tuple[tuple[Refusal, ...], tuple[str, ...], str]:
    """Load why a participant was refused, the conditions whose walk was processed, and the key.

    Parameters
    ----------
    folder : Path
        Folder that `save_refused` wrote.

    Raises
    ------
    SchemaError
        If the file is missing, damaged or of another format.
    """
    data, _, _ = load_unit(folder, "refused.json")
    return tuple(Refusal(**refusal) for refusal in data["refusals"]), tuple(data["walks"]), data["key"]


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
        "tests": run.tests is not None,
        "quantities": [quantity.participant for quantity in run.quantities],
        "over": run.over is not None,
    }
    if run.tests is not None:
        save_tests(run.tests, folder / "tests")
    if run.over is not None:
        save_over(run.over, folder / "over")
    with whole_file(folder / "run.json") as part:
        part.write_text(json_text(data), encoding="utf-8")


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
    data = read_json(folder / "run.json")
    return ResponseRun(
        data["title"],
        data["conditions"]["nominal"],
        data["conditions"]["exo"],
        tuple(load_walk(folder / "walks" / name)[0] for name in data["walks"]),
        tuple(load_response(folder / "responses" / name)[0] for name in data["responses"]),
        tuple(Refusal(**refusal) for refusal in data["refusals"]),
        Provenance(**data["provenance"]),
        load_tests(folder / "tests") if data.get("tests") else None,
        tuple(load_quantity(folder / "quantities" / name)[0] for name in data.get("quantities", ())),
        load_over(folder / "over") if data.get("over") else None,
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


def _curves(arrays: Arrays) -> NDArray[np.float64]:
    return arrays["curves"]


def _held_out(arrays: Arrays) -> HeldOut:
    return HeldOut(arrays["time"], arrays["phi"], arrays["measured"], _keyed(arrays, "predicted_"))


def _residuals(arrays: Arrays) -> dict[str, NDArray[np.float64]]:
    return _keyed(arrays, "residual_")


def _keyed(arrays: Arrays, prefix: str) -> dict[str, NDArray[np.float64]]:
    return {key.removeprefix(prefix): values for key, values in arrays.items() if key.startswith(prefix)}
