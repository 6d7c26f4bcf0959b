from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import vocabulary
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.stated_units import per_kg_findings
from gaitdisc.recording import Recording


def belt(peak_n, pattern=((60, 1.0), (40, 0.0))):
    steps = np.concatenate([np.full(count, peak_n * share) for count, share in pattern] * 3)[:, None]
    return {"forces": Recording(np.arange(len(steps)) / 100, steps, (vocabulary().named("ground_force_r_vy"),))}


def test_a_step_of_ten_newtons_is_per_kg():
    (finding,) = per_kg_findings(belt(10.8))
    assert (finding.kind, finding.channel) == ("per body mass", "ground_force_r_vy")
    assert says(finding.what, "10.8 N and is loaded")


@pytest.mark.parametrize("peak", [60.0, 700.0, 2.0])
def test_a_child_an_adult_and_noise_are_not(peak):
    assert per_kg_findings(belt(peak)) == []


def test_drift_of_an_empty_plate_is_no_step():
    assert per_kg_findings(belt(10.0, ((200, 1.0),))) == []


def test_the_moments_of_a_real_walk_are_in_newton_metres_until_divided_by_its_mass(gait_data):
    trial = read_trial(gait_data.parent / "opensim_gait10dof" / "ID" / "Results" / "subject01_walk_ID.sto")
    moments = trial.stream("moments")
    assert per_kg_findings(trial.streams) == []
    (finding,) = per_kg_findings({"moments": moments.with_values(moments.values / 72.6)})
    assert says(finding.what, "looks like N")
