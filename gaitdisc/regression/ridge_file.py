"""A fitted ridge regression on disk."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np

from gaitdisc.errors import SchemaError
from gaitdisc.recording import Scale
from gaitdisc.regression.fourier_ridge import FourierRidge
from gaitdisc.whole_file import whole_file

FORMAT = 1


def save_ridge(model: FourierRidge, path: Path) -> None:
    """Save a ridge regression; what is loaded again equals it to the last bit.

    path: of an `.npz` file; written whole or not at all
    """
    names = {"format": FORMAT, "inputs": model.inputs, "outputs": model.outputs, "penalty": model.penalty}
    arrays = {
        "names": np.array(json.dumps(names)),
        "x_mean": model.x_scale.mean,
        "x_sd": model.x_scale.sd,
        "y_mean": model.y_scale.mean,
        "y_sd": model.y_scale.sd,
        "frequencies": model.frequencies,
        "phases": model.phases,
        "weights": model.weights,
        "offset": model.offset,
    }
    with whole_file(path) as part, part.open("wb") as file:
        np.savez(file, **arrays)


def load_ridge(path: Path) -> FourierRidge:
    """Load a ridge regression that `save_ridge` wrote."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        names = json.loads(str(arrays["names"]))
        if names["format"] != FORMAT:
            raise ValueError(f"it has format {names['format']}, this version reads {FORMAT}")
        return FourierRidge(
            tuple(names["inputs"]),
            tuple(names["outputs"]),
            Scale(arrays["x_mean"], arrays["x_sd"]),
            Scale(arrays["y_mean"], arrays["y_sd"]),
            arrays["frequencies"],
            arrays["phases"],
            arrays["weights"],
            arrays["offset"],
            names["penalty"],
        )
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise SchemaError(
            f"{path.name} is to be read as a ridge regression of gaitdisc", str(error), "Fit the model again."
        ) from error
