import pytest
from driven_walker import DrivenWalker

from gaitdisc.comparison.compare import compare_walks
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.report.mismatch_tables import channels_table, findings_of, mismatch_text, regions_table


@pytest.fixture(scope="module")
def mismatch():
    walks = [
        DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250.0, "exo"), (0.0, "free"))
    ]
    return compare_walks(*walk_pair(*walks))


def test_every_region_and_every_channel_has_a_row(mismatch):
    assert len(regions_table(mismatch).rows) == len(mismatch.regions) > 0
    assert [row[0] for row in channels_table(mismatch).rows].count("right ankle angle") == 1
    assert len(channels_table(mismatch).rows) == len(mismatch.names)
    assert len(findings_of(mismatch).rows) == len(mismatch.findings)


def test_the_sign_is_printed_and_the_text_lists_all_channels(mismatch):
    first = regions_table(mismatch).rows[0]
    assert first[0].endswith("ankle angle")
    assert first[2][0] in "−+"
    assert mismatch_text(mismatch).row_count >= len(mismatch.names)
