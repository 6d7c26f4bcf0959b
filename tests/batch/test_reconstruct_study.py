from __future__ import annotations

import pytest

from gaitdisc.batch.reconstruct_study import ReconstructionSettings, reconstruct_study
from gaitdisc.errors import SamplingError

KINDS = ("linear", "delay ridge")


def test_every_participant_is_reconstructed_from_own_walks(study):
    done, people = reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=KINDS))
    assert done.participants == ("P01", "P02")
    rmse = done.over_participants()["rmse_deg"]
    assert rmse["delay ridge"] < rmse["linear"]
    assert "knee_angle_r" not in set(done.errors["state"])
    assert done.split.startswith("temporal: each trial: first 70 %")
    assert len(done.provenance.files) == 4
    assert people[0].fitted[1].reconstructor.sensing.lags.count == 25


def test_a_population_needs_three_people(study):
    with pytest.raises(SamplingError, match="needs at least three people: to fit, to check, and to judge; there are 2"):
        reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(split="subject", kinds=KINDS))


def test_a_history_longer_than_the_trial(study):
    settings = ReconstructionSettings(history_s=40.0, kinds=KINDS)
    with pytest.raises(SamplingError, match=r"a window reaches back 39\.96 s; .* lasts 29\."):
        reconstruct_study(study, ("knee_angle_r",), settings)
