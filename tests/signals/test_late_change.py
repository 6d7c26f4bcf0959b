from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import StrideError
from gaitdisc.signals.contact_movement import angle_contacts
from gaitdisc.signals.stride_quality import late_change, late_change_findings
from gaitdisc.signals.strides import cut_strides


@pytest.mark.parametrize("dependence", [0.0, 0.3, 0.6])
def test_a_shift_in_the_last_fifth_is_found_in_four_minutes(made, dependence):
    for seed in range(4):
        recording, strides = made.wandering(224, dependence, seed, shift_sd=1.75)
        found = late_change(recording, strides, seed)
        assert found.p <= 0.01
        assert found.time == pytest.approx(0.8 * 224, abs=6)
        assert found.size_sd > 2
        assert found.shifts["hip_flexion_r"] == pytest.approx(1.75, abs=0.9)


def test_stationary_strides_raise_an_alarm_in_at_most_1_in_20(made):
    cases = [(dependence, 5000 + seed) for seed, dependence in enumerate((0.0, 0.3, 0.6) * 33)]
    p = np.array([late_change(*made.wandering(100, dependence, seed), seed).p for dependence, seed in cases])
    assert np.mean(p <= 0.05) <= 0.05
    assert np.mean(p <= 0.01) <= 0.02


def test_an_angle_that_no_stride_has_at_some_phase_is_left_out_in_silence(made, recwarn):
    recording, strides = made.wandering(40, 0.3, 1)
    values, phi = np.array(recording.values), strides.phi(recording.time)
    values[(phi > 40) & (phi < 60), 0] = np.nan
    found = late_change(recording.with_values(values), strides, 1)
    assert recording.names[0] not in found.shifts and len(found.shifts) > 0
    assert [str(one.message) for one in recwarn] == []


@pytest.mark.slow
def test_false_alarms_stay_below_5_percent(made):
    for count in (40, 80, 224):
        for dependence in (0.0, 0.3, 0.6):
            p = [late_change(*made.wandering(count, dependence, 1000 + seed), seed).p for seed in range(150)]
            assert np.mean(np.array(p) <= 0.05) <= 0.05 + 1.6 * np.sqrt(0.05 * 0.95 / 150)


def test_the_finding_says_when_how_much_and_where(made):
    (finding,) = late_change_findings(*made.wandering(224, 0.3, 1, shift_sd=2.0))
    assert finding.kind == "late change"
    assert finding.what.startswith("gait changes at 1")
    assert "stride-to-stride sd (p = 0.003)" in finding.what
    assert finding.spans[0][0] == pytest.approx(179, abs=6)
    assert says(finding.spoils, "leave the trial")


def test_one_odd_stride_late_is_no_change(made):
    recording, strides = made.wandering(100, 0.0, 3)
    values = recording.values.copy()
    values[(recording.time >= 90) & (recording.time < 91)] += 40
    assert late_change(recording.with_values(values), strides).p > 0.05


def test_too_few_strides_are_refused_and_noted(made):
    recording, strides = made.wandering(20, 0.0, 0)
    with pytest.raises(StrideError, match=r"24 whole strides.*walk\.mot.*19.*'r'"):
        late_change(recording, strides)
    (finding,) = late_change_findings(recording, strides)
    assert finding.severity == "note" and says(finding.what, "not looked for", "walk.mot", "19 of side 'r'")


def test_same_seed_same_p(made):
    recording, strides = made.wandering(60, 0.3, 0)
    assert late_change(recording, strides, 7) == late_change(recording, strides, 7)


def test_a_constant_channel_does_not_count(made):
    recording, strides = made.wandering(60, 0.3, 0)
    values = recording.values.copy()
    values[:, 2] = 1.0
    assert "ankle_angle_r" not in late_change(recording.with_values(values), strides).shifts


@pytest.mark.parametrize("file", ["natural2", "exotendon3"])
def test_real_running_does_not_change_late(gait_data, real, file):
    run = real.mot(gait_data / "exotendon_run" / f"c3d_Trimmed_running_{file}_manual_scaling_ik.mot")
    strides = cut_strides(angle_contacts(run)["r"], run)
    assert late_change_findings(run.selected(real.legs), strides) == []
