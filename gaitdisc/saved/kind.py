"""A kind of result: how it lies in a folder, by one typed codec, and what draws its page. Kinds are known by words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

from gaitdisc.channel import list_names
from gaitdisc.errors import SchemaError
from gaitdisc.own_files import claim_folder, guard
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.saved.unit_folder import NO_KEY, Arrays, OnDisk, load_finding, load_unit, save_unit, with_words
from gaitdisc.whole_file import write_together

if TYPE_CHECKING:
    import pandas as pd

T = TypeVar("T")
KINDS = {  # the JSON file of each result that stands alone, and its kind
    "run.json": "gaitdisc.response.participant_response:RUN",
    "discovery.json": "gaitdisc.discovery.folder:DISCOVERY",
    "reconstruction.json": "gaitdisc.reconstruction.reconstruction:RECONSTRUCTION",
    "mismatch.json": "gaitdisc.comparison.mismatch:MISMATCH",
    "variant_run.json": "gaitdisc.response.variants:VARIANT_RUN",
    "cycles.json": "gaitdisc.processing.pooled_cycles:CYCLES",
    "model.json": "gaitdisc.reconstruction.reconstructor:RECONSTRUCTOR",
}


class CSV(NamedTuple):
    """A table beside the JSON file."""

    file: str
    columns: Sequence[str] | None  # that it must have; None: the table may be missing
    alone: bool = False  # whether it is read with these columns and no others


@dataclass(frozen=True)
class Kind(Generic[T]):
    """How a kind of result lies in a folder; its fields are read back as they are annotated."""

    noun: type[T]
    file: str  # the JSON file; without its ending it is the kind's place in `results.schema.json`
    keys: tuple[str, ...] = ()  # what the JSON file says, in its order: fields, or properties that are not read back
    tables: Mapping[str, CSV] = field(default_factory=dict)  # by field
    arrays: Mapping[str, Callable[[Arrays], Any]] = field(default_factory=dict)  # field -> how it is made of the arrays
    written: Callable[[T], Mapping[str, Values]] | None = None  # all arrays by name
    later: bool = True  # whether arrays are read when they are looked at
    keyed: bool = True  # whether the JSON file says what the result was computed from
    reasons: str = ""  # what the keys of `left_away` are called
    flags: tuple[str, ...] = ()  # columns that are true or false
    words: tuple[str, ...] = ()  # columns whose cells are words, also where they look like numbers
    blank: tuple[str, ...] = ()  # columns of words that may be empty
    write: Callable[[T, Path], object] | None = None  # where the codec does not do: saves
    read: Callable[[Path], T] | None = None  # and loads
    unit: Callable[[T], str] | None = None  # name of the folder of one of many in a run
    page: str = ""  # "module:function" that writes its page into a folder
    page_folder: str = ""  # of the page, in that of the result
    beside: tuple[str, ...] = ()  # folders in that of the result in which results of other kinds may lie

    def save(self, result: T, folder: Path, key: str = NO_KEY) -> None:
        """Save a result; key: what it was computed from, a hash of files and settings."""
        if self.write is not None:
            self.write(result, folder)
            return
        data = {"key": key} if self.keyed else {}
        data |= {name: plain(getattr(result, name), self.reasons) for name in self.keys}
        tables = {csv.file: getattr(result, name) for name, csv in self.tables.items()}
        there = {file: table for file, table in tables.items() if table is not None}
        save_unit(folder, self.file, data, there, self.written(result) if self.written else {})

    def load(self, folder: Path) -> T:
        """Load a result."""
        return self.read(folder) if self.read is not None else self.load_keyed(folder)[0]

    def load_keyed(self, folder: Path) -> tuple[T, str]:
        """Load a result, and the key it was computed from."""
        wanted = {csv.file: csv.columns for csv in self.tables.values() if csv.columns is not None}
        data, tables, arrays = load_unit(folder, self.file, wanted, self.words)
        hints = _hints(self.noun)
        values = {name: _type(hints[name], data[name]) for name in self.keys if name in hints and name in data}
        values |= {name: self._table(csv, tables) for name, csv in self.tables.items()}
        values |= {name: OnDisk(made, arrays) if self.later else made(arrays) for name, made in self.arrays.items()}
        return self.noun(**values), data.get("key", "")

    def kept(self, folder: Path, key: str) -> T | None:
        """Load a result that was computed from this very key; None where there is none that is whole."""
        try:
            result, stored = self.load_keyed(folder)
        except SchemaError:
            return None
        return result if stored == key else None

    def draw(self, result: T, folder: Path) -> Path:
        """Write the page of a result that lies in a folder."""
        return load_word(self.page)(result, folder / self.page_folder)

    def _table(self, csv: CSV, tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame | None:
        table = tables.get(csv.file)
        if table is None:
            return None
        for column in self.blank:
            with_words(table, column)
        for column in self.flags:
            table[column] = table[column].astype(bool)
        return table[list(csv.columns or ())] if csv.alone else table


class Saved:
    """A result that saves itself; its class says in which file, as `class Noun(Saved, file="noun.json")`."""

    _file: ClassVar[str]

    def __init_subclass__(cls, file: str = "", **others: Any) -> None:
        super().__init_subclass__(**others)
        cls._file = file or cls._file

    def save(self, folder: Path | str, overwrite: bool = False) -> Path:
        """Save to a folder that `gaitdisc.load` reads.

        folder: where; made if missing
        overwrite: whether files may be replaced that `save` did not write
        returns: the folder
        """
        place = Path(folder)
        with guard(".save", overwrite=overwrite), write_together():
            claim_folder(place)
            load_word(KINDS[self._file]).save(self, place)
        return place


def find_kind(folder: Path, drawn: bool = False) -> Kind[Any]:
    """Kind of the result that a folder holds; drawn: whether it must have a page, as all but a fitted model have."""
    if not (file := next((name for name in KINDS if (folder / name).is_file()), "")):
        held = sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []
        FolderError = SchemaError if folder.exists() else type("SchemaError", (SchemaError, FileNotFoundError), {})
        raise FolderError(
            f"a saved result must be a folder with one of {', '.join(KINDS)}",
            f"{folder.name} {'contains ' + list_names(held) if folder.is_dir() else 'is not a folder'}",
            "Name the folder that the command or .save(folder) wrote.",
        )
    kind = load_word(KINDS[file])
    if drawn and not kind.page:
        raise SchemaError(
            "pages and citations must come from a saved result",
            f"{folder.name} contains {file}, a fitted model",
            "Name the folder of `gaitdisc reconstruct`, or apply the model to a recording: `gaitdisc apply`.",
        )
    return kind


def load_word(word: str) -> Any:
    """What stands at `module:name`, loaded now: who saves nothing loads no store, who draws nothing no figures."""
    module, _, name = word.partition(":")
    return getattr(import_module(module), name)


def pick_arrays(arrays: Arrays, prefix: str) -> dict[str, Values]:
    """Arrays whose names begin with a prefix, by what follows it."""
    return {key.removeprefix(prefix): values for key, values in arrays.items() if key.startswith(prefix)}


def plain(value: Any, reasons: str = "") -> Any:
    """What JSON holds of a field; of a mapping to reasons, rows that name both."""
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, tuple):
        return [plain(item, reasons) for item in value]
    if isinstance(value, Mapping):
        return [{reasons: name, "reason": why} for name, why in value.items()] if reasons else dict(value)
    return value


def _type(hint: Any, value: Any) -> Any:
    """A field as it is annotated, of what JSON held of it."""
    if get_origin(hint) is tuple:
        return tuple(_type(get_args(hint)[0], item) for item in value)
    if hint is Finding:
        return load_finding(value)
    if is_dataclass(hint) and isinstance(hint, type):
        return hint(**value)
    if get_origin(hint) is Mapping and isinstance(value, list):
        kind = get_args(hint)[0]
        return {kind(cell): str(row["reason"]) for row in value for name, cell in row.items() if name != "reason"}
    return value


@cache
def _hints(noun: type) -> dict[str, Any]:
    names = {item.name for item in fields(noun)}
    return {name: hint for name, hint in get_type_hints(noun).items() if name in names}
