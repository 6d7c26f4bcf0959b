import importlib.util
from pathlib import Path

STUDY = Path(__file__).parents[2] / "studies" / "compare_exo_emg.py"


def test_eight_people_two_settings_paired(gait_data):
    spec = importlib.util.spec_from_file_location("compare_exo_emg", STUDY)
    study = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(study)
    found = study.run(gait_data)
    assert (found.exchange.unit, found.exchange.first, found.exchange.permutations) == ("participant", 8, 128)
    assert found.summary_of("emg_ta_l")["differs"]  # as the signed rank of late stance has it (results/chapter4.md)
    assert found.summary_of("emg_ta_l")["largest_gap"] > 0
    assert len(found.names) == 16
