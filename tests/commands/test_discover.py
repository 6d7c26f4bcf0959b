"""`gaitdisc discover` end to end on a spring that truly has dry friction; and every refusal's words."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from manufactured_discovery import manufactured
from texts import says

from gaitdisc.commands.options import REFUSED, STOPPED
from gaitdisc.discovery.decision import Verdict
from gaitdisc.discovery.folder import load_discovery
from gaitdisc.discovery.power import Power
from gaitdisc.discovery.result import ConditionAnswer, Twins
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.errors import GaitdiscError
from gaitdisc.simulation.simulation_file import read_simulation

SPRING = """title = "Spring"
[states.x]
unit = "m"
[states.v]
unit = "m/s"
[parameters.k]
value = 4.0
unit = "1/s^2"
[parameters.b]
value = 0.1
unit = "1/s"
[equations]
x = "v"
v = "-k*x - b*v"
[observations]
x = "x"
"""
FRICTION = 0.4  # m/s^2
RATE, SUBSTEPS = 50.0, 20


def rows(trials=4, samples=400):
    rng = np.random.default_rng(0)
    rows = []
    for trial in range(1, trials + 1):
        x, v = rng.uniform(0.5, 1.2) * (-1) ** trial, 0.0
        for sample in range(samples):
            rows.append((trial, sample / RATE, x + 0.005 * rng.standard_normal()))
            for _ in range(SUBSTEPS):
                v += (-4.0 * x - 0.1 * v - FRICTION * np.sign(v)) / RATE / SUBSTEPS
                x += v / RATE / SUBSTEPS
    return rows


def write(path, table, head="trial,time,x"):
    lines = [",".join(cell if isinstance(cell, str) else f"{cell:.7g}" for cell in row) for row in table]
    path.write_text("\n".join([head, *lines]) + "\n")


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """Return a folder with good and bad simulations, and good and bad data."""
    folder = tmp_path_factory.mktemp("lab")
    right = "-k*x - b*v"
    bad = {
        "good": right,
        "power": "-k*x - b*v^2",
        "unknown": "-kk*x - b*v",
        "wild": "900*k*x + 40*v*abs(v)",
        "hostile": f"__import__('os').system('touch {folder}/owned')",
        "tower": "9**9**9**9*x",
        "deep": "(" * 5000 + "x" + ")" * 5000,
    }
    for name, expression in bad.items():
        (folder / f"{name}.toml").write_text(SPRING.replace(right, expression))
    port = '[ports.push]\nunit = "N"\n[equations]'
    (folder / "port.toml").write_text(SPRING.replace("[equations]", port))
    (folder / "broken.toml").write_text(SPRING.replace("[equations]", "[equations"))
    (folder / "shape.toml").write_text('[[shape]]\nname = "mine"\npieces = ["import os"]\n')
    table = rows()
    write(folder / "good.csv", table)
    write(folder / "column.csv", table, "trial,time,y")
    write(folder / "short.csv", [row for row in table if row[1] < 0.2])
    write(folder / "constant.csv", [(*row[:2], 1.0) for row in table])
    write(folder / "nan.csv", [*table[:7], (1, 7 / RATE, "?"), *table[8:]])
    return folder


@pytest.fixture
def refusal(lab, called):
    """Words of a refusal, one, after which nothing is written."""

    def refuse(*words):
        done = called("discover", *(lab / word for word in words), "--out", lab / "none", ends=REFUSED)
        assert not (lab / "none").exists() and done.stderr.count("Error: ") == 1
        return done.stderr

    return refuse


@pytest.fixture(scope="module")
def whole(lab, called):
    """Return the folder of a search that was not stopped, and what it said."""
    return lab / "whole", called("discover", lab / "good.toml", lab / "good.csv", "--out", lab / "whole", ends=0)


def test_the_sentence_the_files_and_the_report(whole, unpainted):
    out, done = whole
    sentence = done.stdout.splitlines()[0]
    assert says(sentence, "friction", "0.40")
    assert "the held-out error falls from" in sentence
    found = json.loads((out / "discovery.json").read_text(encoding="utf-8"))
    assert found["sentence"] == sentence
    friction = found["effects"][0]["estimates"]["friction"]
    assert friction["value"] == pytest.approx(FRICTION, rel=0.02)
    assert friction["unit"] == "m/s^2"
    assert read_simulation(out / "augmented.toml").effects[0].name == "coulomb_friction"
    assert sentence[:40] in (out / "report.html").read_text(encoding="utf-8")
    assert "weighing" in done.stderr and "round 1 of at most 5" in done.stderr


def test_a_search_that_is_stopped_continues_with_the_same_command(lab, whole, tmp_path, monkeypatch, called):
    """Stopped twice, it gives the numbers of the one that was not, to the last bit, and fits nothing again."""
    words, fits, descended = (
        ("discover", lab / "good.toml", lab / "good.csv", "--out", tmp_path),
        [],
        Shooting._descend,
    )

    def stopping_at(last):
        def counted(self, machine, now, *more):
            fits.append(bool(now.free))
            if sum(fits) > last:
                raise KeyboardInterrupt
            return descended(self, machine, now, *more)

        fits.clear()
        monkeypatch.setattr(Shooting, "_descend", counted)

    stopping_at(3)
    assert says(called(*words, "--no-report", ends=STOPPED).stderr, "Stopped. Finished parts are kept; the same")
    stopping_at(3)
    anew = called(*words, "--no-report", "--overwrite", ends=STOPPED).stderr
    assert "continuing" not in anew and "the same command without --overwrite continues from there." in anew
    stopping_at(40)
    assert "Stopped. So far: Coulomb friction in the equation of v; " in called(*words, ends=STOPPED).stderr
    stopping_at(np.inf)
    assert "continuing an earlier run: " in called(*words, "--no-report", ends=0).stderr
    monkeypatch.setattr(Shooting, "_descend", descended)
    for file in ("held_out.csv", "augmented.toml"):
        assert (tmp_path / file).read_bytes() == (whole[0] / file).read_bytes()
    found, wanted = (json.loads((one / "discovery.json").read_text(encoding="utf-8")) for one in (tmp_path, whole[0]))
    own = {"provenance", "own_sha256"}
    assert {name: found[name] for name in found.keys() - own} == {name: wanted[name] for name in wanted.keys() - own}
    assert not (tmp_path / "kept").exists()


def test_the_answer_stands_before_its_twins_are_searched(lab, tmp_path, monkeypatch, called, unpainted):
    """What twins say is printed and written after it; the search of twins is tested in tests/discovery."""
    twins, before = Twins(20, "no_gap", {}, {"no_gap": 19, "gravity@v": 1}), []

    def searched(found, *_):
        before.append(json.loads((tmp_path / "discovery.json").read_text(encoding="utf-8")))
        return replace(found, twins=twins)

    monkeypatch.setattr("gaitdisc.discovery.discover.decide", lambda _, as_read: Verdict(as_read, ()))
    monkeypatch.setattr("gaitdisc.discovery.discover_files.search_twins", searched)
    words = (lab / "good.toml", lab / "good.csv", "--out", tmp_path, "--twins", "20", "-q")
    sentence, report, said, again = called("discover", *words, ends=0).stdout.splitlines()
    assert before[0]["sentence"] == sentence and "twins" not in before[0] and report == again
    assert (
        said
        == "In simulated records like these, the search names an effect in 1 of 20 records in which nothing is missing."
    )
    found, page = load_discovery(tmp_path), (tmp_path / "report.html").read_text(encoding="utf-8")
    assert found.twins == twins and said in page and "How often the search finds this answer" in page


def test_twins_are_refused_where_an_engine_runs_the_model(lab, tmp_path, called):
    done = called("discover", lab / "leg.xml", lab / "good.csv", "--twins", "2", "--out", tmp_path, ends=REFUSED)
    assert says(done.stderr, "twins and a plan need a simulation file or a Python function", "leg.xml", "Leave both")


def test_a_plan_says_from_which_size_on_an_effect_is_found(lab, tmp_path, monkeypatch, called):
    """Which records are counted is tested in tests/discovery."""
    power = Power("coulomb_friction@v", "friction", "m/s^2", (0.1, 0.2), (4, 10), 10)
    planned = lambda model, data, request: [power] if (request.effects, request.twins) == ((power.effect,), 10) else []  # noqa: E731
    monkeypatch.setattr("gaitdisc.discovery.power.find_power", planned)
    words = (lab / "good.toml", lab / "good.csv", "--out", tmp_path, "--plan", "--effects", power.effect)
    said = called("discover", *words, ends=0).stdout.splitlines()
    assert said == [power.sentence, f"plan: {tmp_path / 'plan.csv'}"]
    table = pd.read_csv(tmp_path / "plan.csv")
    assert table["size"].tolist() == [0.1, 0.2] and table["found"].tolist() == [4, 10]
    assert set(table["effect"]) == {power.effect} and set(table["unit"]) == {"m/s^2"}


def test_without_a_report_and_without_progress(lab, tmp_path, monkeypatch, called):
    """Whatever is found; the search is that of the test above."""
    monkeypatch.setattr("gaitdisc.discovery.discover.decide", lambda _, as_read: Verdict(as_read, ()))
    words = (lab / "good.toml", lab / "good.csv", "--out", tmp_path, "--no-report", "-q")
    assert called("discover", *words, ends=0).stderr == ""
    files = ["augmented.toml", "discovery.json", "held_out.csv"]
    assert sorted(path.name for path in tmp_path.iterdir()) == [".written-by-gaitdisc", *files]
    assert sorted(json.loads((tmp_path / "discovery.json").read_text())["sha256"]) == ["augmented.toml", "held_out.csv"]


@pytest.mark.parametrize(
    ("simulation", "said"),
    [
        ("power", "power.toml, line 14, [equations] v: expressions must be arithmetic on names; at column 11"),
        ("unknown", "found the unknown name 'kk'. Did you mean 'k'?"),
        ("port", "port.toml, line 12, [ports] push: a port must be used in an equation or a definition"),
        ("broken", "broken.toml must be a TOML file; Expected ']'"),
        ("absent", "a simulation must be a TOML file; absent.toml: No such file"),
        ("wild", "'Spring' diverges in trial 1 after t = "),
        ("hostile", "SchemaError: hostile.toml, line 14, [equations] v: expressions must be arithmetic on names"),
        ("tower", "every state of a simulation must stay within"),
        ("deep", "deep.toml, line 14, [equations] v"),
    ],
)
def test_simulations_that_are_refused(lab, refusal, simulation, said):
    assert said in refusal(f"{simulation}.toml", "good.csv")
    assert not (lab / "owned").exists()


def test_a_simulation_that_blows_up_names_the_parameter(refusal):
    assert says(refusal("wild.toml", "good.csv"), "'k'", "affects this state most")


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ("column", "the measured data must have a column 'x'; column.csv has trial, time, y."),
        ("short", "a trial must have 20 samples; short.csv, trial '1' has 10."),
        ("constant", "the observed channel 'x' must vary; constant.csv has 1 in every sample."),
        ("nan", "nan.csv, line 9 (trial '1'), column 'x'"),
        ("absent", "measured data must be a table; absent.csv: No such file"),
    ],
)
def test_data_that_are_refused(refusal, data, said):
    assert said in refusal("good.toml", f"{data}.csv")


def test_one_file_is_not_enough(refusal):
    assert says(refusal("good.toml"), "good.toml", "measured table after")


def test_a_catalogue_that_does_not_parse(lab, called):
    words = (lab / "good.toml", lab / "good.csv", "--catalogue", lab / "shape.toml")
    assert says(called("discover", *words, ends=REFUSED).stderr, "shape.toml, shape 1", "'import os'")


def test_of_one_trial_it_says_what_cannot_be_held_out(lab, tmp_path, called):
    write(lab / "one.csv", rows(1))
    done = called("discover", lab / "good.toml", lab / "one.csv", "--out", tmp_path, "--no-report", ends=0)
    assert says(done.stderr, "'1'", "(400 samples)")
    assert says(done.stderr, "later", "can be held")


def test_of_a_study_everyone_is_searched_and_who_is_refused_costs_nobody_else(lab, tmp_path, monkeypatch, called):
    person = '[[participants]]\nid = "{}"\n[[participants.trials]]\ncondition = "nominal"\nfiles = ["a.mot"]\n'
    people = "".join(map(person.format, ("W01", "W02", "W03")))
    conditions = '[conditions]\nnominal = "nominal"\ndevice = "exo"\nothers = ["soft", "turn"]\n'
    (tmp_path / "study.toml").write_text(f'title = "three"\n{conditions}{people}')

    def searched(_, who, *rest):
        assert rest[-1] == "knee_angle"
        if who == "W02":
            raise GaitdiscError("walks of W02 are needed", "one is there", "Name the other.")
        rows = (ConditionAnswer("exo", "", "no_gap"), ConditionAnswer("turn", "walks are needed"))
        return dict.fromkeys(("exo", "soft"), (manufactured(conditions=rows), read_simulation(lab / "good.toml")))

    monkeypatch.setattr("gaitdisc.discovery.discover_device.discover_study", searched)
    words = ("--participant", "all:knee_angle", "--out", tmp_path / "found", "--no-report", "-q")
    done = called("discover", tmp_path / "study.toml", *words, ends=3)
    assert says(done.stderr, "walks of W02", "turn: refused: walks are needed")
    assert says(done.stdout, "2 of 2", "286")
    people = pd.read_csv(tmp_path / "found" / "people.csv").query("number == 'stiffness'")
    assert people[["condition", "who"]].values.tolist() == [[word, "W01 286, W03 286"] for word in ("exo", "soft")]
    for folder in ("W03", "W03/W03-soft"):
        assert load_discovery(tmp_path / "found" / folder).verdict == "missing_physics"

    def refused(_, who, *rest):
        raise GaitdiscError(f"walks of {who} are needed", "one is there", "Name the other.")

    monkeypatch.setattr("gaitdisc.discovery.discover_device.discover_study", refused)
    done = called("discover", tmp_path / "study.toml", *words, "--overwrite", ends=1)
    assert done.stderr.count("refused: walks of W0") == 3 and done.stdout.split() == ["W01:", "W02:", "W03:"]
