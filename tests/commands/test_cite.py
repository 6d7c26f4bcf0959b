from manufactured_discovery import manufactured
from texts import says

import gaitdisc
from gaitdisc.commands.options import REFUSED


def test_bibtex_is_printed_or_written_with_what_each_entry_is_for(called, tmp_path):
    folder = manufactured().save(tmp_path / "found")
    said = called("cite", folder).stdout
    assert said.startswith("% this program\n@software{gaitdisc,")
    assert f"version = {{{gaitdisc.__version__}}}" in said
    assert "% multiple shooting\n@inproceedings{bock1984," in said
    done = called("cite", folder, "--out", tmp_path / "methods.bib")
    assert (tmp_path / "methods.bib").read_text(encoding="utf-8") == said
    assert done.stdout == f"{tmp_path / 'methods.bib'}: {said.count('@')} entries\n"


def test_a_folder_without_a_result_is_refused(called, tmp_path):
    done = called("cite", tmp_path)
    assert done.returncode == REFUSED and says(done.stderr, "a saved result")
