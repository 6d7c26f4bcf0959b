import planted_faults
import pytest


@pytest.mark.slow
def test_three_faults_in_three_files_are_found_and_the_files_themselves_raise_no_alarm(gait_data):
    found, alarms = planted_faults.outcomes(gait_data.parent, quick=True)
    assert alarms == []
    assert [one.found for one in found] == [True, True, True]
    assert planted_faults.table(found)[-1] == ("all", 3, 3, 0, 0)
