"""The response of one person to a device."""

import pytest

import gaitdisc as gd
from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.results.participant_response import R2_COLUMNS

OUTPUTS = ("ankle_angle_r",)


@pytest.fixture(scope="module")
def walks():
    return gd.example_walks(30.0)


@pytest.mark.usefixtures("trained_briefly")
def test_two_walks_become_a_run_that_is_saved_and_drawn(walks, tmp_path):
    run = gd.fit_response(walks["nominal"], walks["exo"], OUTPUTS, ["ankle_angle_r", "knee_angle_r", "hip_flexion_r"])
    table = run.to_frame()
    assert set(R2_COLUMNS) <= set(table) and set(table["variable"]) == set(OUTPUTS)
    ridge = table[(table["kind"] == "ridge") & (table["walk"] == "exo")].set_index("model")["r2"]
    assert ridge["augmented"] > ridge["nominal"]  # a spring at the ankle that only the one walk has
    again = gd.load(run.save(tmp_path / "run"))
    assert isinstance(again, gd.ResponseRun) and again.to_frame().equals(table)
    assert again.provenance.settings["models"]["outputs"] == list(OUTPUTS)
    assert gd.plot.r2(again).get_xlim()[1] == 1.0
    assert gd.plot.curves(again, "ankle_angle_r").get_title() == "ankle angle, right"
    assert "median R² of augmented" in again._repr_html_()


def test_an_output_that_is_no_angle_of_both_is_refused(walks):
    with pytest.raises(ChannelError, match="'ankle_angle_q' is not among hip_flexion_r"):
        gd.fit_response(walks["nominal"], walks["exo"], ("ankle_angle_q",))


def test_a_share_in_percent_is_refused_and_one_output_is_a_name(walks):
    with pytest.raises(SamplingError, match=r"0.*1; held_out_share.*12.5"):
        gd.fit_response(walks["nominal"], walks["exo"], held_out_share=12.5)
    with pytest.raises(ChannelError, match="'ankle' is not among"):
        gd.fit_response(walks["nominal"], walks["exo"], outputs="ankle")
