"""Twins of a record have its times, gaps and noise, and the search of them finds what was planted."""

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.catalogue import Request
from gaitdisc.discovery.discover import explain
from gaitdisc.discovery.discover_files import find_missing
from gaitdisc.discovery.kept_work import kept_work
from gaitdisc.discovery.result import Twins
from gaitdisc.discovery.twins import TwinSource, refuse_twins
from gaitdisc.errors import SchemaError

EXACT = Request(twins=2)


def with_gaps(measured):
    observed = measured.observed.copy()
    observed[:, 40:44] = np.nan
    return replace(measured, observed=observed)


@pytest.fixture(scope="module", params=[4, 1], ids=["four trials", "one trial"])
def source(request):
    """Return what twins of a cubic spring's record are drawn from, and that record."""
    measured = with_gaps(record(with_load("-14*x**3"), 3, Experiment(trials=request.param, seconds=8.0)))
    case, as_read, verdict = explain(mass(), measured)
    return *(TwinSource(case, now, verdict.found.noise) for now in (verdict.found, as_read)), measured


def test_a_twin_has_the_records_times_gaps_and_noise(source):
    source, base, measured = source
    (twin, other), without = (source.draw(number) for number in (0, 1)), base.draw(0)
    assert twin.trials == measured.trials and twin.channels == measured.channels
    assert (np.isnan(twin.observed) == np.isnan(measured.observed)).all()
    assert (twin.drive.time0 == measured.drive.time0).all() and (twin.drive.inputs == measured.drive.inputs).all()
    noise = source.noise.size
    assert np.nanstd(twin.observed - other.observed, axis=(0, 1)) == pytest.approx(np.sqrt(2) * noise, rel=0.1)
    assert np.nanstd(twin.observed - measured.observed, axis=(0, 1)) == pytest.approx(np.sqrt(2) * noise, rel=0.2)
    assert (np.nanstd(without.observed - measured.observed, axis=(0, 1)) > 2 * noise).all()


@pytest.fixture(scope="module", autouse=True)
def one_process():
    """Search twins in this process: others take seconds to begin."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gaitdisc.discovery.twins.MOST_PROCESSES", 1)
        yield


@pytest.fixture(scope="module")
def searched():
    """Return the answer with its twins, and what was handed on before they began."""
    model, measured, before = mass(), record(with_load("-14*x**3"), 3, Experiment(seconds=6.0)), []
    answered = Request(twins=2, answered=lambda *both: before.append(both))
    return find_missing(model, measured, answered, {})[0], before, (model, measured)


@pytest.mark.slow
def test_what_was_planted_returns_and_nothing_is_invented(searched):
    found, ((before, augmented),), _ = searched
    assert found.twins == Twins(2, "cubic_stiffness@load", {"cubic_stiffness@load": 2}, {"no_gap": 2})
    assert found.to_json()["twins"]["with_effects"] == {"cubic_stiffness@load": 2}
    assert before.twins is None and before.sentence == found.sentence and augmented.effects
    assert found.twins.sentence == (
        "In simulated records like these, the search gives the same answer in 2 of 2 records with the effect, and "
        "names an effect in 0 of 2 records in which nothing is missing."
    )


@pytest.mark.slow
def test_twins_that_were_searched_are_not_searched_again(searched, tmp_path, monkeypatch):
    found, _, (model, measured) = searched
    lines = []

    def stopping(line):
        lines.append(line)
        if line.startswith("3 of 4"):
            raise KeyboardInterrupt

    def search(progress):
        with kept_work(tmp_path, lambda _: None):
            return find_missing(model, measured, replace(EXACT, progress=progress), {})[0]

    with pytest.raises(KeyboardInterrupt):
        search(stopping)
    lines.clear()
    again = search(lines.append)
    searched = [line.partition(" simulated")[0] for line in lines if "simulated records" in line]
    assert searched == ["3 of 4", "4 of 4"]
    assert again.twins == found.twins


def test_a_run_that_leaves_the_record_has_no_twins(source, monkeypatch):
    monkeypatch.setattr("gaitdisc.discovery.twins.FLED", -1.0)
    assert source[0].draw(0) is None


def test_what_an_engine_runs_has_no_twins():
    with pytest.raises(
        SchemaError, match=r"twins and a plan need a simulation file .*; leg.xml is neither. Leave them out"
    ):
        refuse_twins("leg.xml")
