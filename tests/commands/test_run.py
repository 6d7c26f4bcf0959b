import pytest

from gaitdisc.commands.options import SOME_REFUSED

pytestmark = pytest.mark.usefixtures("unpainted")


def test_the_batch_goes_on_past_a_broken_file(study, recordings, tmp_path, called):
    text = (study / "study.toml").read_text()
    folder = tmp_path / "two"
    (folder / "raw").mkdir(parents=True)
    for name in ("natural", "exo"):
        (folder / "raw" / f"{name}.mot").write_bytes((recordings / "walker1" / f"{name}.mot").read_bytes())
    (folder / "raw" / "broken.mot").write_text("Coordinates\n")
    head = text[: text.index("[[participants]]")]
    good = '[[participants]]\nid = "P01"\n' + "".join(
        f'[[participants.trials]]\ncondition = "{name}"\nfiles = ["raw/{name}.mot"]\n' for name in ("natural", "exo")
    )
    (folder / "raw" / "other.mot").write_bytes((folder / "raw" / "natural.mot").read_bytes() + b"\n")
    bad = good.replace("P01", "P02").replace("raw/exo.mot", "raw/broken.mot").replace("raw/natural", "raw/other")
    (folder / "study.toml").write_text(head + bad + good)
    done = called("run", folder, "--quiet")
    assert done.returncode == SOME_REFUSED, done.stderr
    assert "refused: P02 exo:" in done.stderr
    assert "P02 exo, file 1" in done.stderr and "broken.mot" not in done.stderr  # the study says which file it is
    assert "1 participant in" in done.stdout
    checked = called("check", folder)
    assert "broken.mot" in checked.stdout
    assert checked.returncode == SOME_REFUSED
    assert "Traceback" not in checked.stderr
