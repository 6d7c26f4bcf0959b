from datetime import UTC, datetime, timedelta

from gaitdisc.results.provenance import Refusal, code_sha256, installed_versions, made_now


def test_versions_name_what_computes_the_numbers():
    versions = installed_versions()
    assert {"gaitdisc", "python", "numpy", "torch", "ezc3d"} <= set(versions)
    assert all(versions.values())
    assert code_sha256()[:12] in versions["gaitdisc"]


def test_what_is_made_now_says_when_and_by_what():
    made = made_now({"filters": {"order": 4}}, 3, {"a.mot": "ff"}, "4.2")
    assert (made.settings, made.seed, made.files, made.section) == (
        {"filters": {"order": 4}},
        3,
        {"a.mot": "ff"},
        "4.2",
    )
    assert made.versions == installed_versions()
    assert timedelta(0) <= datetime.now(UTC) - datetime.fromisoformat(made.created) < timedelta(minutes=1)


def test_a_refusal_is_a_participant_a_walk_and_a_reason():
    assert Refusal("P01", "", "why").reason == "why"
    assert Refusal("P01", "walk 2", "why") != Refusal("P01", "walk 3", "why")
