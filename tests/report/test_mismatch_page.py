from html.parser import HTMLParser

from driven_walker import DrivenWalker

from gaitdisc.comparison.compare import compare_walks
from gaitdisc.processing.walk_pair import walk_pair
from gaitdisc.report.mismatch_page import write_mismatch_report


def test_the_page_answers_first_and_needs_nothing_but_itself(tmp_path):
    walks = [
        DrivenWalker("A", seed=1, spring_per_s2=k).walked(25.0, name) for k, name in ((250.0, "exo"), (0.0, "free"))
    ]
    found = compare_walks(*walk_pair(*walks), ("ankle_angle_r", "knee_angle_r"))
    page = write_mismatch_report(found, tmp_path)
    text = page.read_text(encoding="utf-8")
    HTMLParser().feed(text)
    assert text.index("In A exo the right ankle") < text.index("<figure>") < text.index("How the numbers were made")
    assert "http" not in text.split("</head>")[1]
    assert "<script" not in text
    assert (tmp_path / "channels" / "ankle_angle_r.csv").read_text().startswith("percent,first,second,")
    assert {file.name for file in (tmp_path / "tables").iterdir()} >= {"regions.csv", "channels.csv", "findings.csv"}
    first = page.read_bytes()
    assert write_mismatch_report(found, tmp_path).read_bytes() == first
