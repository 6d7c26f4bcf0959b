import importlib
import os
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def study():
    return importlib.import_module("emps")


@pytest.fixture(scope="module")
def found(study):
    data = Path(os.environ.get("GAITDISC_DATA", PROJECT.parent / "shared" / "data")) / "hidden_effect" / "emps"
    if not (data / "DATA_EMPS.mat").exists():
        pytest.skip(f"the motor's record is absent: {data} (set GAITDISC_DATA)")
    return study.run(True, data)


def test_dry_friction_is_named_first_and_of_the_published_size(study, found):
    assert (found.named, found.place) == ("coulomb_friction", "carriage")
    assert found.friction_n == pytest.approx(study.PUBLISHED_N, rel=0.06)  # mass and damping move within their bounds


def test_free_runs_that_were_never_fitted_lose_three_quarters_of_their_error(found):
    for before, after in found.left_mm.values():
        assert after < 0.25 * before


def test_the_model_is_the_published_one_without_friction(study):
    values = study.gd.read_simulation(study.MODEL).values()
    assert values == {"mass": 95.1089, "viscous": 203.5034, "offset": -3.1648}


def test_the_results_page_has_what_the_quick_run_prints(study, found):
    from printed_blocks import apart, blocks

    text = (PROJECT / "studies" / "results" / "discovery.md").read_text(encoding="utf-8")
    [block] = [block for block in blocks(text) if "emps.py" in block.commands[-1]]
    assert apart("\n".join(block.written.splitlines()[1:3]), "\n".join(study.lines(found)[:2])) == ""
