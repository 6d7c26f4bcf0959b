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
from gaitdisc.discovery.scored_model import Part
from gaitdisc.discovery.twins import TwinSource, list_changes, refuse_twins, say_apart, sped_up, weigh_run
from gaitdisc.errors import SchemaError
from gaitdisc.simulation.compiled_simulation import Drive

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


@pytest.fixture(scope="module")
def tied(source):
    """Return the source, and a linear spring in the place of the cubic one."""
    case, now = source[0].decided, source[0].now
    linear = next(one for one in case.search.candidates if one.label == "linear_stiffness@load")
    return source[0], case.search.with_others(now, (Part(linear, {"factor": -1.0}),))


def test_a_run_is_fitted_by_what_made_it_and_not_by_a_rival(tied):
    source, rival = tied
    other, measured = replace(source, now=rival), source.case.measured
    assert weigh_run(source, source, measured, 1.0) == pytest.approx(0.0, abs=1e-3)
    assert weigh_run(source, other, measured, 1.5) > weigh_run(source, other, measured, 1.0) > 20


def test_the_change_that_distinguishes_best_is_said(tied, monkeypatch):
    source, rival = tied
    monkeypatch.setattr("gaitdisc.discovery.twins.CLEARLY", 1e9)
    least = say_apart(source, [rival])
    assert least.startswith("None of 6 simulated changes of the measurement would distinguish the tied explanations")
    most = int(least.rpartition(" ")[2][:-2])
    monkeypatch.setattr("gaitdisc.discovery.twins.CLEARLY", 0.99 * most)
    said = say_apart(source, [rival])
    assert " times as large would best distinguish the answer from linear stiffness at the load port: expected " in said
    assert f"evidence {most}, now " in said
    monkeypatch.setattr("gaitdisc.discovery.twins.FLED", -1.0)  # no run stays
    assert say_apart(source, [rival]).endswith("evidence: at most 0).")


def test_a_walks_phase_is_not_sped_up(source):
    case = source[0].case
    assert [words for words, _, _ in list_changes(case)][1:3] == [
        "inputs 0.5 times as fast",
        "inputs 0.5 times as large",
    ]
    inputs = case.search.base.inputs
    base = replace(case.search.base, inputs=(*inputs, replace(inputs[0], name="phase")))
    walk = replace(case, search=replace(case.search, base=base))
    assert [words.split()[0] for words, _, _ in list_changes(walk)] == ["no", "initial", "initial"]


def test_inputs_that_are_faster_go_back_at_the_end():
    drive = Drive.of([np.arange(5.0)[:, None], np.arange(3.0)[:, None]], 1.0)
    assert sped_up(drive, 2.0).inputs[..., 0].tolist() == [[0, 2, 4, 2, 0], [0, 2, 0, 0, 0]]
    assert sped_up(drive, 0.5).inputs[..., 0].tolist() == [[0, 0.5, 1, 1.5, 2], [0, 0.5, 1, 0, 0]]


def test_what_an_engine_runs_has_no_twins():
    with pytest.raises(SchemaError, match=r"twins and a plan need a simulation file .*leg.xml is neither. Leave both"):
        refuse_twins("leg.xml")
