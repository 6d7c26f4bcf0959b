"""A result on disk: it saves itself to a folder, and any of them is read back by the JSON file of that folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from gaitdisc.channel import list_names
from gaitdisc.errors import SchemaError
from gaitdisc.own_files import claim_folder, guarded
from gaitdisc.whole_file import written_together

if TYPE_CHECKING:
    import pandas as pd

HERE = "gaitdisc.results"
READERS = {  # the JSON file of each kind, and what reads its folder
    "run.json": f"{HERE}.run_store:load_run",
    "discovery.json": f"{HERE}.discovery_folder:load_discovery",
    "reconstruction.json": f"{HERE}.stores:RECONSTRUCTION.load",
    "mismatch.json": f"{HERE}.stores:MISMATCH.load",
    "variant_run.json": f"{HERE}.stores:load_variant_run",
    "cycles.json": f"{HERE}.stores:CYCLES.load",
}


class Saved:
    """A result that saves itself; its class says by what, as `class Kind(Saved, by="module:function")`."""

    _by: ClassVar[str]

    def __init_subclass__(cls, by: str, **others: Any) -> None:
        super().__init_subclass__(**others)
        cls._by = by

    def save(self, folder: Path | str, overwrite: bool = False) -> Path:
        """Save to a folder that `gaitdisc.load` reads.

        folder: where; made if missing
        overwrite: whether files may be replaced that `save` did not write
        returns: the folder
        """
        place = Path(folder)
        with guarded(".save", overwrite=overwrite), written_together():
            claim_folder(place)
            _function(self._by)(self, place)
        return place


def check_columns(tables: Mapping[str, tuple[pd.DataFrame, Sequence[str]]], needing: str, do: str) -> None:
    """Refuse a result of which a table lacks columns; tables: name -> the table, and the columns it must have."""
    for name, (table, columns) in tables.items():
        missing = [column for column in columns if column not in table]
        if missing:
            raise SchemaError(
                f"{needing} the columns {', '.join(columns)} in {name}", f"{name} lacks {', '.join(missing)}", do
            )


def load_saved(folder: Path, readers: Mapping[str, str] = READERS) -> Any:
    """Read whatever result a folder holds; what was changed since is refused."""
    for name, reader in readers.items():
        if (folder / name).is_file():
            return _function(reader)(folder)
    held = sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []
    raise SchemaError(
        f"a saved result is a folder with one of {', '.join(readers)}",
        f"{folder.name} {'holds ' + list_names(held) if folder.is_dir() else 'is no folder'}",
        "Give the folder that the command or .save(folder) wrote.",
    )


def _function(place: str) -> Callable[..., Any]:
    """What stands at `module:name` or `module:name.method`, loaded now: a result that is not saved loads no store."""
    module, _, name = place.partition(":")
    return attrgetter(name)(import_module(module))
