"""The studies of chapter 3 answer as the chapter says."""

import ch3_burgers
import ch3_systems
import ch3_who_names
import numpy as np
import pytest
from chapter3 import pages
from chapter3.cell import cell_of
from chapter3.further_numbers import FILTERS, filtered
from chapter3.record import Conditions, recorded
from texts import says


def test_the_pulse_of_the_text_cannot_run():
    assert says(ch3_burgers.text_start(ch3_burgers.Conditions(duration_s=2.0)), "every bound at 0 s")


@pytest.mark.slow
def test_the_quick_study_shows_both_metrics(tmp_path):
    result = ch3_burgers.run(quick=True, folder=tmp_path)
    assert "by the mean error" in result.tables[0].rows[1][2]


def test_the_hidden_term_is_in_the_first_equation():
    system = ch3_systems.lorenz()
    x = system.start[None]
    assert (system.true(x) - system.known(x)).round(9).tolist() == [[-5.12, 0.0, 0.0]]


@pytest.mark.slow
def test_no_learned_rate_loses_before_the_first_jump_but_that_of_dmd(tmp_path):
    cells = ch3_systems.run("lorenz", quick=True, folder=tmp_path).cells["done right"]
    for cell in cells:
        if cell.approach == "dynamics" and cell.method not in ("dmd", "bopdmd"):
            part = cell.parts["oracle forecast"]
            assert part.accuracy(until_s=part.first_jump_s()).min() > 80


@pytest.mark.parametrize("name", FILTERS[:2])
def test_the_unscented_filter_finds_the_gain_from_either_start(name):
    record = recorded(ch3_systems.biased_masses()["code"], Conditions(noise=0.001, duration_s=20.0))
    end, sd = filtered(record, name)
    assert 1 + end[2] == pytest.approx(1.1, abs=min(1e-3, 3 * sd))


@pytest.mark.slow
def test_every_method_removes_most_of_the_bias_without_noise(tmp_path):
    cells = ch3_systems.run("measurement_bias", quick=True, folder=tmp_path).cells
    assert all(
        cell.parts["reconstruction"].accuracy()[0] > 95
        for found in cells.values()
        for cell in found
        if not cell.noise and cell.method != "bopdmd"  # its mean over bags mixes modes whose eigenvalues are rounding
    )


def test_the_system_is_drawn_with_the_rate_that_it_lacks(van_der_pol):
    cells = {"text": (cell_of(recorded(van_der_pol, Conditions(duration_s=5.0)), "sindy", "dynamics"),)}
    figures = {"system": "Fig. 3.2", "dynamics": "Fig. 3.3", "noise": "Fig. 3.5"}
    stated, variant = pages.blocks_of(cells, figures, (), {"text": van_der_pol})
    assert [figure.name for figure in variant.figures] == ["system-1", "dynamics-1", "noise-1"]
    numbers = variant.figures[0].numbers
    assert np.allclose(numbers["missing rate"], -0.01 * numbers["x truth"] ** 3)
    assert stated.tables[0].rows[0][0] == "Fig. 3.2"


def test_text_and_code_hide_a_term_of_opposite_sign_and_start_apart():
    text, code = ch3_systems.oscillators().values()
    x = text.start[None] * 0 + 2.0
    assert (text.true(x) - text.known(x))[0, 1] == pytest.approx(-0.08)
    assert (code.true(x) - code.known(x))[0, 1] == pytest.approx(0.08)
    assert (text.start.tolist(), code.start.tolist()) == ([0.1, 5.0], [0.1, 0.1])


@pytest.mark.slow
def test_the_quick_study_answers_every_statement(tmp_path):
    result = ch3_systems.run("van_der_pol", quick=True, folder=tmp_path)
    section = ch3_systems.SECTIONS["van_der_pol"]
    captions = [section.figures[each] for each in ("system", "cost")]
    assert [row[0] for row in result.tables[0].rows] == [where for where, *_ in section.stated] + captions
    assert (tmp_path / "tables.md").exists()


def test_what_sindy_should_say_is_what_is_hidden():
    for case in ch3_who_names.cases():
        x = case.system.start[None] + np.array([[0.3], [0.7]])
        gap = case.system.true(x) - case.system.known(x)
        if case.approach == "dynamics" and case.terms:
            powers = {"x**3": x[:, 0] ** 3, "y": x[:, 1], "x**2*y": x[:, 0] ** 2 * x[:, 1]}
            for output, terms in case.terms.items():
                written = sum(value * powers[term] for term, value in terms.items())
                assert gap[:, case.system.states.index(output)] == pytest.approx(written)
        if not case.words:
            assert not gap.any()


@pytest.mark.slow
def test_the_quick_study_names_the_cubic_of_the_text(tmp_path):
    table = ch3_who_names.run(quick=True, folder=tmp_path).tables[0]
    assert table.rows[0][4].startswith("named")
    assert (tmp_path / "figures" / "names.svg").exists()
