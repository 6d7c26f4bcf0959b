"""JSON with a hash of its own: what was changed since it was written is refused, and named."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.errors import SchemaError
from gaitdisc.results.sealed_json import OWN, check_files, file_sha256, read_sealed, sealed_text

NUMBERS = st.floats(allow_nan=False) | st.integers() | st.text() | st.booleans() | st.none()


@settings(max_examples=60, deadline=None)
@given(data=st.dictionaries(st.text().filter(lambda key: key != OWN), NUMBERS | st.lists(NUMBERS, max_size=3)))
def test_what_is_written_is_read(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("sealed") / "walk.json"
    path.write_text(sealed_text(data), encoding="utf-8")
    assert read_sealed(path) == json.loads(json.dumps(data))


def test_another_order_and_another_editors_line_ends_change_nothing(tmp_path):
    path = tmp_path / "walk.json"
    named = json.loads(sealed_text({"seconds": 60.0, "rate_hz": 100.0}))
    path.write_bytes(json.dumps(dict(reversed(named.items()))).replace(",", ",\r\n").encode())
    assert read_sealed(path) == {"seconds": 60.0, "rate_hz": 100.0}


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (lambda text: text.replace("100.0", "999.0"), "walk.json.*edited|walk.json.*changed"),
        (lambda text: text.replace(OWN, "other"), "walk.json.*without a hash of its own: an older version of gaitdisc"),
        (lambda text: text[:-8], "walk.json.*not readable as JSON"),
        (lambda text: "[" * 100_000, "walk.json.*nested too deeply"),
        (lambda text: "[1, 2]", "walk.json.*no JSON object"),
    ],
)
def test_what_was_changed_is_refused(tmp_path, changed, words):
    path = tmp_path / "walk.json"
    path.write_text(changed(sealed_text({"seconds": 60.0, "rate_hz": 100.0})))
    with pytest.raises(SchemaError, match=words):
        read_sealed(path)


def test_a_file_that_is_missing_is_named(tmp_path):
    with pytest.raises(SchemaError, match=r"walk\.json.*missing"):
        read_sealed(tmp_path / "walk.json")


def test_files_beside_it_are_held_against_their_hashes(tmp_path):
    file = tmp_path / "curves.csv"
    file.write_text("1,2\n")
    hashes = {"curves.csv": file_sha256(file)}
    check_files(tmp_path, hashes)
    file.write_text("1,3\n")
    with pytest.raises(SchemaError, match=r"curves\.csv"):
        check_files(tmp_path, hashes)
    file.unlink()
    with pytest.raises(SchemaError, match=r"curves\.csv.*missing"):
        check_files(tmp_path, hashes)
