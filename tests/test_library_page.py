"""The scripts of docs/library.md run as they stand, are short, and their pictures are there."""

import matplotlib.pyplot as plt
import pytest
from library_pictures import DOCS, MOST_LINES, PICTURES, blocks, run_script, scripts
from texts import says

import gaitdisc as gd

QUICK = ("cycles", "reconstruction")


def test_there_is_a_picture_of_each_and_none_is_long():
    page = (DOCS / "library.md").read_text(encoding="utf-8")
    assert list(scripts()) == list(PICTURES)
    for name, text in scripts().items():
        assert f"](pictures/{name}.png)" in page and (DOCS / "pictures" / f"{name}.png").is_file()
        assert len([line for line in text.splitlines() if line.strip()]) <= MOST_LINES, name
        assert [line for line in text.splitlines() if "from gaitdisc" in line or "import gaitdisc." in line] == []


@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=() if each in QUICK else pytest.mark.slow) for each in PICTURES]
)
def test_a_script_runs_as_it_stands(tmp_path, name, trained_briefly):
    run_script(scripts()[name], tmp_path)
    assert (tmp_path / f"{name}.png").stat().st_size > 5000
    assert len(plt.gcf().axes[0].lines) > 1
    results = [path.parent for path in tmp_path.glob("*/*.json")]
    assert len(results) == (name in ("discovery", "response"))
    assert all(gd.load(folder) for folder in results)


def test_scripts_without_a_picture_run_as_they_stand(tmp_path, capsys):
    plain = [block for block in blocks() if block not in scripts().values()]
    printed = (
        ("Trial('the table'", "kinematics 1", "100 Hz"),
        ("Strides(11", "side 'r'", "0.25 to 11.25 s", "[60.  0.]"),
        ("knee", "10", "5.0", "2.5", "6.0", "0.003906"),
        ("'-12.2625*sin(angle)'",),
    )
    for script, words in zip(plain, printed, strict=True):
        assert len([line for line in script.splitlines() if line.strip()]) <= MOST_LINES
        run_script(script, tmp_path)
        assert says(capsys.readouterr().out, *words)
