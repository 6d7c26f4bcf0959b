from html.parser import HTMLParser

from gaitdisc.report.reconstruction_page import write_reconstruction_report


def test_the_page_answers_first_and_needs_nothing_but_itself(reconstruction, tmp_path):
    page = write_reconstruction_report(reconstruction, tmp_path)
    text = page.read_text(encoding="utf-8")
    HTMLParser().feed(text)
    parts = ("From a 1 other state is reconstructed", "<figure>", "How the numbers were made")
    assert sorted(parts, key=text.index) == list(parts)
    assert "http" not in text.split("</head>")[1]
    assert {file.name for file in (tmp_path / "tables").iterdir()} >= {"models.csv", "states.csv", "participants.csv"}
    first = page.read_bytes()
    assert write_reconstruction_report(reconstruction, tmp_path).read_bytes() == first
