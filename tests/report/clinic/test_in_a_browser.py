"""Pages in a real browser, where there is one: nothing overflows, the cursor reads, a hostile name runs nothing."""

import html
import json
import re
import shutil
import subprocess

import pytest
from made_clinic import PROVENANCE, made_controls, made_person, made_run

from gaitdisc.clinic.clinical_reference import PersonSession
from gaitdisc.clinic.person_page import index_rows, write_index, write_person_page
from gaitdisc.clinic.reading import contrast, read_beside
from gaitdisc.saved.provenance import Refusal

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
HOSTILE = '<img src=x onerror="document.title=1">'
# A frame of a page of the same folder, as wide as a telephone or a desk; what is found in it becomes the title.
OUTSIDE = """<!DOCTYPE html><title>waiting</title><iframe src="{page}" width="{width}" height="900"></iframe><script>
const frame = document.querySelector("iframe");
frame.addEventListener("load", () => {{
  const page = frame.contentDocument, root = page.documentElement;
  const svg = page.querySelector("figure.panel svg");
  let said = "", moved = [];
  if (svg) {{
    const box = svg.getBoundingClientRect();
    const there = {{clientX: box.left + 165 / 300 * box.width}};
    svg.dispatchEvent(new frame.contentWindow.PointerEvent("pointermove", there));
    moved = [...page.querySelectorAll("figcaption output")].map(one => one.textContent);
    said = moved[0];
  }}
  document.title = JSON.stringify({{
    wide: root.scrollWidth, seen: root.clientWidth, said, moved: moved.filter(Boolean).length,
    panels: page.querySelectorAll("figure.panel").length, images: page.images.length, title: page.title,
    columns: new Set([...page.querySelectorAll("#kinematics ~ .sheet > figure.panel")].map(f => f.offsetLeft)).size
  }});
}});
</script>"""
pytestmark = [pytest.mark.slow, pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine")]


def _ran(*options):
    words = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", *options]
    return subprocess.run(words, capture_output=True, text=True, timeout=120, check=False).stdout


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    reference = made_controls(20)
    person = made_person(HOSTILE, each=6, changed={"knee_angle_l": -30.0})
    first = read_beside(person, reference)
    second = read_beside(made_person(HOSTILE, condition=f"turn {HOSTILE}", each=6), reference)
    session = PersonSession(f"P01 {HOSTILE}", (first, second), (contrast(first, second),))
    write_person_page(session, "P01", reference, PROVENANCE, folder)
    refused = Refusal("P02", "walk", f"a_file_of_a_very_long_name_{'x' * 90} {HOSTILE}")
    write_index(made_run(person, refusals=(refused,)), index_rows(session, "P01"), reference, folder)
    return folder


def _seen(folder, page, width):
    outside = folder / f"outside_{width}.html"
    outside.write_text(OUTSIDE.format(page=page, width=width), encoding="utf-8")
    options = ("--allow-file-access-from-files", "--virtual-time-budget=8000", "--window-size=1400,1000")
    dumped = _ran(*options, "--dump-dom", outside.as_uri())
    return json.loads(html.unescape(re.search(r"<title>(.*?)</title>", dumped, re.DOTALL)[1]))


@pytest.mark.parametrize("width", [400, 1300])
def test_a_page_fits_a_telephone_and_a_desk_and_its_cursor_reads_every_panel(pages, width):
    seen = _seen(pages, "people/P01.html", width)
    assert seen["wide"] <= seen["seen"]
    assert seen["said"].startswith(" 50 %: L ") and seen["moved"] == seen["panels"] > 20
    assert seen["images"] == 0 and seen["title"].endswith("gait report")
    assert seen["columns"] == (1 if width == 400 else 3)


def test_what_is_too_wide_is_seen_as_such(pages):
    (pages / "wide.html").write_text("<title>w</title><div style='width: 700px'>a</div>", encoding="utf-8")
    seen = _seen(pages, "wide.html", 400)
    assert seen["wide"] > 600 > seen["seen"]


@pytest.mark.parametrize("width", [400, 1300])
def test_the_index_fits_and_runs_nothing(pages, width):
    seen = _seen(pages, "index.html", width)
    assert seen["wide"] <= seen["seen"]
    assert seen["images"] == 0 and seen["title"].endswith("people")


def test_printed_on_a4_there_are_two_pages_before_all_values(pages):
    printed = pages / "P01.pdf"
    page = (pages / "people" / "P01.html").as_uri()
    _ran("--no-pdf-header-footer", f"--print-to-pdf={printed}", page)
    assert printed.read_bytes()[:5] == b"%PDF-"
    if shutil.which("pdftotext"):
        text = subprocess.run(["pdftotext", "-layout", printed, "-"], capture_output=True, text=True, check=True).stdout
        sheets = text.split("\f")
        assert "Kinematics" in sheets[0] and "foot progression" in sheets[0]
        assert "EMG" in sheets[1] and "All values" not in sheets[1]
        assert "All values" in sheets[2]
