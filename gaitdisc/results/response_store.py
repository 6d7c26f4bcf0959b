"""Saving and loading of what was fitted to one participant, or why not: `responses/`, `quantities/`, `refused/`."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.results.on_disk import Arrays
from gaitdisc.results.participant_response import (
    FIT_COLUMNS,
    QUANTITY_COLUMNS,
    R2_COLUMNS,
    DataQuantity,
    HeldOut,
    ParticipantResponse,
)
from gaitdisc.results.provenance import Refusal
from gaitdisc.results.unit_folder import Keyed, load_unit, save_unit


def save_response(response: ParticipantResponse, folder: Path, key: str) -> None:
    """Save the response of one participant.

    key: what it was computed from: a hash of files and settings
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
            **{f"band_{model}": values for model, values in held.bands.items()},
            **{f"residual_{model}": values for model, values in response.residuals.items()},
        },
    )


def load_response(folder: Path) -> Keyed[ParticipantResponse]:
    """Load the response of one participant, and the key it was computed from."""
    data, tables, arrays = load_unit(folder, "response.json", {"r2.csv": R2_COLUMNS, "fits.csv": FIT_COLUMNS})
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
    return Keyed(response, data["key"])


def save_quantity(quantity: DataQuantity, folder: Path, key: str) -> None:
    """Save what less data would have given for one participant.

    key: what it was computed from: a hash of files and settings
    """
    left_away = [{"length_s": length, "reason": reason} for length, reason in quantity.left_away.items()]
    data = {"key": key, "participant": quantity.participant, "part": quantity.part, "left_away": left_away}
    save_unit(folder, "quantity.json", data, {"quantity.csv": quantity.table}, {})


def load_quantity(folder: Path) -> Keyed[DataQuantity]:
    """Load what less data would have given, and the key it was computed from."""
    data, tables, _ = load_unit(folder, "quantity.json", {"quantity.csv": QUANTITY_COLUMNS})
    left_away = {float(row["length_s"]): str(row["reason"]) for row in data["left_away"]}
    quantity = DataQuantity(data["participant"], data["part"], tables["quantity.csv"], left_away)
    return Keyed(quantity, data["key"])


def save_refused(refusals: tuple[Refusal, ...], walks: tuple[str, ...], folder: Path, key: str) -> None:
    """Save why a participant was refused, so that a run that goes on does not read and process the walks again.

    key: what it was computed from: a hash of files and settings
    """
    data = {"key": key, "refusals": [asdict(refusal) for refusal in refusals], "walks": list(walks)}
    save_unit(folder, "refused.json", data, {}, {})


class Refused(NamedTuple):
    """Why a participant was refused, the conditions whose walk was processed, and the key of what this rests on."""

    refusals: tuple[Refusal, ...]
    walks: tuple[str, ...]
    key: str


def load_refused(folder: Path) -> Refused:
    """Load why a participant was refused."""
    data, _, _ = load_unit(folder, "refused.json")
    return Refused(tuple(Refusal(**refusal) for refusal in data["refusals"]), tuple(data["walks"]), data["key"])


def _held_out(arrays: Arrays) -> HeldOut:
    return HeldOut(
        arrays["time"], arrays["phi"], arrays["measured"], _keyed(arrays, "predicted_"), _keyed(arrays, "band_")
    )


def _residuals(arrays: Arrays) -> dict[str, NDArray[np.float64]]:
    return _keyed(arrays, "residual_")


def _keyed(arrays: Arrays, prefix: str) -> dict[str, NDArray[np.float64]]:
    return {key.removeprefix(prefix): values for key, values in arrays.items() if key.startswith(prefix)}
