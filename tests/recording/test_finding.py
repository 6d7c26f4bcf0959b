import pytest
from texts import says

from gaitdisc.recording import Finding


def test_line_without_channel():
    assert says(
        Finding("note", "second reader", "a.c3d", "read by c3d", "").line(),
        "note: a.c3d",
        "second reader",
        "read by c3d",
    )


def test_the_severest_comes_first():
    findings = [Finding(severity, "gap", "a.c3d", "", "") for severity in ("note", "refused", "warning")]
    assert [f.severity for f in sorted(findings, key=lambda f: f.rank)] == ["refused", "warning", "note"]


def test_unknown_severity():
    with pytest.raises(ValueError, match="severity is one of"):
        Finding("fatal", "gap", "a", "b", "c")
