"""The studies that make the tables and figures of chapters 3, 4 and 5: their names, and what each costs."""

from pathlib import Path
from typing import NamedTuple

from gaitdisc.errors import SchemaError

OUT = "OUT"  # stands for the folder of the part
METHODS = ("pysindy", "pydmd")  # libraries of the extra `chapter3`


class Part(NamedTuple):
    """A part of a chapter."""

    chapter: int
    name: str
    study: str
    makes: str
    minutes: float  # of one core, about
    quick_minutes: float  # of one core, about, with `--quick`
    words: tuple[str, ...] = (OUT,)  # what the study is called with
    quick_words: tuple[str, ...] = ()  # and with `--quick`; where empty, the same and `--quick`
    needs: tuple[str, ...] = ()
    data: str = ""  # folder of recordings or fields without which there is nothing to compute


PARTS = (
    Part(3, "tables", "ch3_tables", "all tables of 3.4, from the results that are included", 0.1, 0.1,
         words=("all",), quick_words=("all",)),
    Part(3, "van_der_pol", "ch3_systems", "3.4.1, Figs. 3.2-3.5, 3.11", 20, 0.7,
         words=("van_der_pol", OUT), needs=METHODS),
    Part(3, "lorenz", "ch3_systems", "3.4.2, Figs. 3.6-3.11", 25, 0.5, words=("lorenz", OUT), needs=METHODS),
    Part(3, "burgers", "ch3_burgers", "3.4.3, Fig. 3.12", 60, 0.3, needs=METHODS),
    Part(3, "measurement_bias", "ch3_systems", "3.4.4, Fig. 3.13", 8, 0.2,
         words=("measurement_bias", OUT), needs=METHODS),
    Part(3, "who_names", "ch3_who_names", "which method names the effect (3.4 and 3.5)", 30, 0.3, needs=METHODS),
    Part(3, "seeds", "ch3_seeds", "results of `tables` for each data set, start and seed", 120, 0.3, needs=METHODS),
    Part(3, "further", "ch3_further", "further methods, noise, starts and trajectories of 3.4 and 3.5", 40, 0.5,
         quick_words=(OUT, "--seeds", "1", "--tables", "variance"), needs=METHODS),
    Part(4, "ankle_exo", "ch4_ankle_exo", "the entire chapter, Figs. 4.2-4.4", 9, 0.7),
    Part(4, "bands", "ch4_further", "4.4, 6.2.2, runners: band coverage, sparse terms, network size, curve", 4, 0.7,
         words=(OUT, "--tables", "band", "people", "terms", "search", "curve"), data="gait/exotendon_run"),
    Part(4, "outcomes", "ch4_further", "6.2.2: joint moments and metabolic power of real people as outcomes", 0.1, 0.1,
         words=(OUT, "--tables", "moments", "energy"), data="gait/ankle_exo_emg_grf"),
    Part(5, "gait_individual", "ch5_gait", "5.3.3, upper Table 5.2, Fig. 5.4", 60, 0.3, words=("individual", OUT)),
    Part(5, "gait_population", "ch5_gait", "5.3.3, lower Table 5.2, Fig. 5.5", 90, 0.7, words=("population", OUT)),
    Part(5, "sea_surface", "ch5_sea_surface", "5.3.2, Table 5.1, Figs. 5.1, 5.3", 5, 0.2, data="fields/sst_pacific"),
    Part(5, "turbulence", "ch5_turbulence", "5.3.1, Fig. 5.2, on substitute data", 8, 0.3),
    Part(5, "real_people", "ch5_further", "5.2, Fig. 5.1, 5.3.3, 6.2.3: the text's network, people, forecasts", 12, 0.7,
         words=(OUT, "--tables", "text", "latent", "population", "ahead", "turns"),
         quick_words=(OUT, "--quick", "--tables", "text", "population", "turns"), data="gait/exotendon_run"),
    Part(5, "beyond", "ch5_further", "6.2.3 and later work: few strides, speed, spread, simulated walkers", 6, 0.4,
         words=(OUT, "--tables", "few", "speed", "spread", "simulated"),
         quick_words=(OUT, "--quick", "--tables", "few", "speed"), data="gait/exotendon_run"),
)  # fmt: skip
CHAPTERS = tuple(dict.fromkeys(part.chapter for part in PARTS))


def list_parts(chapter: int, name: str = "") -> tuple[Part, ...]:
    """Parts of a chapter, or the one of that name.

    >>> [part.name for part in list_parts(4)]
    ['ankle_exo', 'bands', 'outcomes']
    """
    if chapter not in CHAPTERS:
        raise SchemaError(
            f"the chapter must be one of {', '.join(map(str, CHAPTERS))}", f"it is {chapter}", "Name one of these."
        )
    parts = tuple(part for part in PARTS if part.chapter == chapter)
    names = [part.name for part in parts]
    if name and name not in names:
        from gaitdisc.channel import hint_nearest  # brings numpy, and the help of every command lists the parts

        raise SchemaError(
            f"the part of chapter {chapter} must be one of {', '.join(names)}",
            f"found {name!r}" + hint_nearest(name, names),
            "Name one of them, or omit the name to compute all.",
        )
    return tuple(part for part in parts if name in ("", part.name))


def costs() -> str:
    """The parts with what each makes and costs, a line each."""
    lines = [
        f"{part.chapter} {part.name}: {part.makes}; {_minutes(part.minutes)} ({_minutes(part.quick_minutes)})"
        for part in PARTS
    ]
    return "\n".join(lines)


def studies_folder() -> Path:
    """Folder of the studies, in a checkout or in an installed wheel."""
    package = Path(__file__).parents[1]
    installed = package / "studies"
    return installed if installed.is_dir() else package.parent / "studies"


def _minutes(count: float) -> str:
    return f"{60 * count:.0f} s" if count < 1 else f"{count:.0f} min"
