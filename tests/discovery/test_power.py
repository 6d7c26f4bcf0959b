"""The size that is found in 19 of 20 records, against a known law; and which records are counted."""

import math

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record
from scipy.stats import norm

from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.power import SIZES, Power, find_power, tabulate_power
from gaitdisc.errors import SchemaError

MANY = 10_000


def counted(*found, sizes=(1.0, 2.0, 4.0), records=10, instead=""):
    return Power("viscous_damping@load", "damping", "N s/m", sizes, found, records, instead)


def test_a_normal_distribution_of_log_size_is_recovered():
    sizes, (middle, spread) = np.geomspace(0.1, 10.0, 9), (math.log(0.8), 0.5)
    found = np.round(MANY * norm.cdf((np.log(sizes) - middle) / spread)).astype(int)
    power = counted(*found.tolist(), sizes=tuple(sizes.tolist()), records=MANY)
    assert power.least == pytest.approx(math.exp(middle + norm.ppf(0.95) * spread), rel=0.01)


def test_the_sentence_says_where_the_sizes_end():
    found, seldom = (
        f"Viscous damping at load is found in {word}19 of 20 records like these" for word in ("", "fewer than ")
    )
    assert counted(0, 4, 10).sentence.startswith(f"{found} if the damping is at least ")
    assert counted(10, 10, 10).sentence == f"{found} even with a damping of 1.0 N s/m."
    assert counted(0, 1, 9).sentence == f"{seldom}, up to a damping of 4.0 N s/m."
    assert counted(0, 0, 0, instead="gravity@load").sentence == (
        f"{seldom}, up to a damping of 4.0 N s/m; in most records with 4.0 N s/m the answer is gravity@load."
    )


def test_records_have_more_and_more_of_the_effect(monkeypatch):
    """A record counts where exactly this effect is named; two sizes that are found end it; positive damping resists."""
    measured, factors = record(mass(), 3, Experiment(trials=2, seconds=6.0)), []

    def searched(sources, _, request):
        for source, number in ((one, k) for one in sources for k in range(request.twins)):
            now, begun = source.now, source.begun
            place = now.machine.parameters.index(now.names[0]["factor"])
            factors.append((now.fit.values[place], number + len(begun.parts)))  # it begins without
            yield "viscous_damping@load" if len(factors) > 10 else "no_gap"

    monkeypatch.setattr("gaitdisc.discovery.power.search_records", searched)
    (found,) = find_power(mass(), measured, Request(effects=("viscous_damping@load",), twins=2))
    sizes = np.repeat(found.sizes, 2)
    assert found.found == (0,) * 5 + (2,) * 2 and (found.number, found.unit, found.records) == ("damping", "N s/m", 2)
    assert [number for _, number in factors] == [0, 1] * 7
    assert [factor for factor, _ in factors] == pytest.approx((-sizes).tolist())
    assert np.diff(np.log(found.sizes)) == pytest.approx(np.diff(np.log(SIZES[:7])))
    assert sizes[9] < found.least <= sizes[12]
    assert tabulate_power([found])["found"].tolist() == [*found.found]


def test_a_plan_needs_effects():
    with pytest.raises(SchemaError, match=r"plan must name the effects .*; no effect is given\. Name the effects: --"):
        find_power(mass(), record(mass(), 3, Experiment(trials=2, seconds=6.0)), Request(twins=2))
