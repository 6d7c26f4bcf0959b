"""Any saved result, read back."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitdisc.errors import SchemaError

if TYPE_CHECKING:
    from gaitdisc.library.reconstructor import Reconstructor
    from gaitdisc.results import PooledCycles, ResponseRun
    from gaitdisc.results.discovery import Discovery
    from gaitdisc.results.mismatch import Mismatch
    from gaitdisc.results.reconstruction import Reconstruction
    from gaitdisc.results.variants import VariantRun

KINDS = {
    "run.json": ("gaitdisc.results.run_store", "load_run"),
    "discovery.json": ("gaitdisc.results.discovery_folder", "load_discovery"),
    "reconstruction.json": ("gaitdisc.results.reconstruction", "load_reconstruction"),
    "mismatch.json": ("gaitdisc.results.mismatch_folder", "load_mismatch"),
    "variant_run.json": ("gaitdisc.results.variant_store", "load_variant_run"),
    "cycles.json": ("gaitdisc.results.cycles_store", "load_cycles"),
    "model.json": ("gaitdisc.library.reconstructor", "load_reconstructor"),
}


def load(
    folder: Path | str,
) -> ResponseRun | Discovery | Reconstruction | Mismatch | VariantRun | PooledCycles | Reconstructor:
    """Load a result that a command or `.save(folder)` wrote; what was changed since is refused.

    Parameters
    ----------
    folder : path
        Folder of the result: of `gaitdisc run`, `discover`, `compare`, `reconstruct`, or of a result's `save`.

    Returns
    -------
    ResponseRun, Discovery, Reconstruction, Mismatch, VariantRun, PooledCycles or Reconstructor
        As the folder says.

    Raises
    ------
    SchemaError
        If the folder holds no result, or one that is damaged, incomplete or of a format that this version does not
        read (docs/compatibility.md).

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.load("found").sentence  # doctest: +SKIP
    """
    place = Path(folder)
    for name, (module, function) in KINDS.items():
        if (place / name).is_file():
            read: Callable[[Path], Any] = getattr(import_module(module), function)
            found = read(place)
            return found[0] if isinstance(found, tuple) else found
    held = sorted(path.name for path in place.iterdir())[:6] if place.is_dir() else []
    raise SchemaError(
        f"a saved result is a folder with one of {', '.join(KINDS)}",
        f"{place.name} {'holds ' + (', '.join(held) or 'nothing') if place.is_dir() else 'is no folder'}",
        "Give the folder that the command or .save(folder) wrote.",
    )
