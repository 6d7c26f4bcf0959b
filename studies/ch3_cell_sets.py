"""Sets of cells of section 3.4 that stand in one table, over twelve noise seeds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import ch3_burgers
from ch3_systems import FINE, SECTIONS, biased_masses, lorenz, oscillators
from chapter3.burgers import burgers, local_cell, recorded_field
from chapter3.cell import FOUR_METHODS, NOISES, DiscrepancyCell, cell_of
from chapter3.kept_cells import FURTHER
from chapter3.methods import Method, MethodSettings
from chapter3.record import Approach, Conditions, Record, System, further_start, recorded

LONG, SHORT = 50.0, 10.0


@dataclass(frozen=True, eq=False)
class CellSet:
    """Cells that stand in one table."""

    system: System
    conditions: Conditions
    approach: Approach = "dynamics"
    methods: tuple[Method, ...] = FOUR_METHODS
    noises: tuple[float, ...] = NOISES  # shares of each channel's standard deviation
    seeds: int = 12
    settings: MethodSettings | None = None
    field: bool = False  # its noise is taken out over space too, and all but DMD learn one function of each point

    def record(self, **conditions: float) -> Record:
        """A record under the conditions of the set but for these."""
        return (recorded_field if self.field else recorded)(self.system, replace(self.conditions, **conditions))

    def cell(self, record: Record, method: Method) -> DiscrepancyCell:
        """What a method makes of a record."""
        if self.field and method != "dmd":
            return local_cell(record, method)
        return cell_of(record, method, self.approach, self.settings)


def cell_sets() -> dict[str, CellSet]:
    """Every set by its name, in the order in which they are computed."""
    (text, code), mass, chaotic = oscillators().values(), biased_masses(), lorenz()
    long, short, swing = Conditions(duration_s=LONG), Conditions(duration_s=SHORT), Conditions(duration_s=20.0)
    bias = {"approach": "state", "settings": SECTIONS["measurement_bias"].settings}
    found = {
        "van_der_pol_text": CellSet(text, long),
        "lorenz": CellSet(chaotic, long),
        "van_der_pol_code": CellSet(code, long),
        "van_der_pol_text_short": CellSet(text, short, noises=NOISES[1:]),
        "lorenz_short": CellSet(chaotic, short, noises=NOISES[1:]),
        "lorenz_fine": CellSet(chaotic, FINE, methods=("sindy", "gp", "nn"), noises=NOISES[:1]),
        "mass_code": CellSet(mass["code"], swing, **bias),
        "mass_text": CellSet(mass["text"], swing, **bias),
        "van_der_pol_text_state": CellSet(text, long, "state"),
        "van_der_pol_code_state": CellSet(code, long, "state"),
        "lorenz_state": CellSet(chaotic, long, "state"),
    }
    for name, cubic in zip(("burgers", "burgers_code"), ch3_burgers.CUBICS.values(), strict=True):
        found[name] = CellSet(burgers(cubic), long, seeds=6, settings=ch3_burgers.SETTINGS, field=True)
    return found | {
        f"{name}{FURTHER}{number:02d}": replace(begun, noises=NOISES[1:], seeds=6)
        for name in ("van_der_pol_text", "lorenz")
        for number, begun in enumerate(begun_elsewhere(found[name]), 1)
    }


def begun_elsewhere(cells: CellSet) -> list[CellSet]:
    """The same cells from ten further starts, drawn from where the training part went."""
    record = recorded(cells.system, cells.conditions)
    starts = [further_start(record.truth[: record.split], number) for number in range(1, 11)]
    return [replace(cells, system=replace(cells.system, start=start)) for start in starts]


def chosen_sets(names: list[str] | None, noises: list[float] | None) -> dict[str, CellSet]:
    """Sets of these names, at these noises; all where absent."""
    sets, some = cell_sets(), set(noises or NOISES)
    return {
        name: replace(sets[name], noises=tuple(n for n in sets[name].noises if n in some)) for name in names or sets
    }
