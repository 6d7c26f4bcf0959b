import gaitdisc
from gaitdisc.report.page import write_page


def test_a_page_lies_in_its_folder_and_says_the_version(tmp_path):
    page = write_page("blocks", {"title": "T", "about": "6 Hz & 30 s.", "blocks": []}, tmp_path / "new")
    assert page == tmp_path / "new" / "report.html"
    text = page.read_text(encoding="utf-8")
    assert f"6 Hz &amp; 30 s. Made by gaitdisc {gaitdisc.__version__}." in text
    assert "\r" not in page.read_bytes().decode()
