import clinic_rules
import pytest


@pytest.mark.slow
def test_what_is_planted_is_found_on_pages_of_few_people():
    rows = list(clinic_rules.run(quick=True))
    assert [row["planted"] for row in rows] == ["nothing", "stiff knee", "drop foot", "child"]
    assert rows[0]["said elsewhere"] == 0
    assert all(row["found"] <= row["pages"] == 2 for row in rows)
