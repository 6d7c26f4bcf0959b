from __future__ import annotations

from unittest.mock import patch

from gaitdisc.batch import installation
from gaitdisc.batch.installation import checks


def test_what_is_written_is_read_back_here():
    found = {one.what: one for one in checks()}
    assert {found[f"reads {kind}"].state for kind in ("C3D", ".mot", "CSV")} == {"ok"}
    assert found["numpy"].state == "ok" and found["gaitdisc"].words.startswith("0.")


def test_a_reader_that_fails_or_reads_other_numbers_is_wrong():
    other = installation._knee()

    def shifted(folder):
        made, file = installation._storage(folder)
        return made.with_values(made.values + 1.0), file

    assert installation._read_back(".mot", shifted).words == "other numbers than were written"
    failed = installation._read_back("CSV", lambda folder: (other, "none.csv"))
    assert failed.state == "wrong" and "none.csv" in failed.words


def test_a_library_that_is_absent_is_said_with_what_it_is_for():
    with patch.object(installation, "EXTRAS", {"no_such_library": "something"}):
        assert [one.words for one in checks() if one.what == "no_such_library"] == ["needed for something"]
