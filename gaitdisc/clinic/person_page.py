"""Page of a person and session, one file that is mailed, its PDF; and the week's index: refused first, then amber."""

import base64
import hashlib
import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from markupsafe import Markup

from gaitdisc._version import __version__
from gaitdisc.clinic.clinical_reference import ClinicalReading, ClinicalReference, Contrast, PersonSession
from gaitdisc.clinic.page_words import ENGLISH, TIERS, PageWords
from gaitdisc.clinic.panels import contrast_sheet, emg_sheet, panel_numbers, raw_numbers, sheet
from gaitdisc.clinic.sentences import (
    contrast_heading,
    contrast_sentences,
    laboratory_sentences,
    name_walk,
    outstanding_sentences,
    quality_sentence,
    score_sentences,
    write_noted,
)
from gaitdisc.clinic.values import MARKS, change_table, numbers_table, profile_svg, profile_table, values_table
from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import FORCES, KINEMATICS, MOMENTS, POWERS
from gaitdisc.report.curve_panels import MOST_SINGLE, TEMPLATES, Panel, svg
from gaitdisc.report.figure import file_names
from gaitdisc.report.page import page_text
from gaitdisc.report.table import Table, save_table, save_tables, words_table
from gaitdisc.saved.provenance import Provenance
from gaitdisc.saved.study_run import StudyRun
from gaitdisc.whole_file import write_whole
from gaitdisc.words import NONE, counted, number

NO_PDF = ("PDF requires the package typst", "it is not installed", "Install it: pip install 'gaitdisc[pdf]'.")
MOMENT_SIGNS = (
    "Moments are internal (of the muscles), per kg of body mass, and named after the movement that they produce. Power "
    "is positive when it is generated. Forces are those of the ground on the foot. Only cycles in which the "
    "leg's own foot was alone on one plate for the entire stance are shown."
)
EMG = (
    "Envelopes are in percent of the peak of the leg's mean envelope. Dark bars show roughly when the muscle is active "
    "in healthy adults (Perry and Burnfield 2010); a muscle without a bar is not in that source."
)
RAW = " Below the envelopes: raw EMG of one cycle of each leg, the cycle whose envelopes are closest to their means."
CYCLES = (
    f"Thick lines: means; thin lines: single cycles (the first {MOST_SINGLE}). CMC: coefficient of multiple "
    "correlation of a leg's cycles, left and right (Kadaba 1989); 1 if all cycles are identical; a dash if undefined."
)
CONTRAST = (
    "Dotted lines: {}; solid or dashed lines: {}. Bars above, in the leg's colour, show differences in a permutation "
    "test of the cycles, corrected for the entire cycle, all curves and both legs. Faint bars: differences below 5 deg."
)
LIGHT_MARKS = {"green": "●", "amber": "▲", "red": "■"}
RANKS = {"red": 0, "amber": 1, "green": 2}
COLUMNS = ("light", "person", "condition", "cycles", "score", "noted", "why")
HEADINGS = ("state", "person", "condition", "cycles L, R", "profile score [deg]", "stands out", "why")


def write_person_page(
    person: PersonSession,
    name: str,
    reference: ClinicalReference | None,
    provenance: Provenance,
    folder: Path,
    say: PageWords = ENGLISH,
    pdf: bool = False,
) -> list[Path]:
    """Write `people/<name>.html`, where wanted the PDF, and the folder of its numbers; the same bytes for the same."""
    beside = folder / "people" / name
    main, *others = person.readings
    script = (TEMPLATES / "cursor.js").read_text(encoding="utf-8")
    files = {file: sha256 for reading in person.readings for file, sha256 in reading.pooled.files.items()}
    shown = {
        "say": say,
        "title": person.title,
        "laboratory": say.laboratory.name,
        "logo": Markup(say.laboratory.logo),
        "said": laboratory_sentences(person, say),
        "conditions": "; ".join(dict.fromkeys(reading.pooled.condition for reading in person.readings)),
        "reference": _reference(reference, main.pooled.condition),
        "computed": f"Computed {provenance.created[:10]} with gaitdisc {__version__}.",
        "main": _condition(main, beside, "", say),
        "others": [_condition(reading, beside, f"{reading.pooled.condition}-", say) for reading in others],
        "first": [_contrast(person.before_after, beside, say)] if person.before_after else [],
        "contrasts": [_contrast(pair, beside, say) for pair in person.contrasts if pair is not person.before_after],
        "method": _method(person),
        "files": _save(
            words_table("files", f"Files, n = {len(files)}.", ("file", "SHA-256"), files.items()), beside, "", say
        ),
        "versions": say.table(words_table("versions", "Versions.", ("what", "version"), provenance.versions.items())),
        "script": Markup(script),
        "script_hash": f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}",
    }
    page = write_whole(folder / "people" / f"{name}.html", page_text("person", shown))
    return [page, write_person_pdf(shown, page.with_suffix(".pdf"))] if pdf else [page]


def write_person_pdf(shown: Mapping[str, Any], path: Path) -> Path:
    """Write the PDF of what a page shows; the same bytes for the same numbers.

    Words and curves are set in DejaVu Sans, which matplotlib brings, so that sheets are alike on all machines.
    """
    import matplotlib as mpl
    import typst

    style = (TEMPLATES / "curves.css").read_text(encoding="utf-8") + "svg text { font-family: 'DejaVu Sans'; }"
    picture = list(base64.b64decode(shown["logo"].partition(",")[2]))
    page = json.dumps({**shown, "style": style, "picture": picture}, default=_as_json)
    template, fonts = TEMPLATES / "person.typ", [Path(mpl.get_data_path(), "fonts", "ttf")]
    try:
        sheets = typst.compile(template, root=TEMPLATES, font_paths=fonts, sys_inputs={"page": page}, timestamp=0)
    except typst.TypstError as error:
        raise SchemaError("typst must typeset the page", f"it reports: {error}", "Save the logo again.") from error
    return write_whole(path, sheets)


def _as_json(value: object) -> Any:
    """What the template reads of a word list, a table or a panel."""
    if isinstance(value, PageWords):
        return value.other
    if isinstance(value, Table):
        return {"columns": value.columns, "rows": value.rows, "caption": value.caption}
    assert isinstance(value, Panel)
    return {"title": value.title, "unit": value.unit, "note": value.note, "span": value.span, "alt": value.alt}


def list_sheets(reading: ClinicalReading) -> dict[str, tuple[list[Panel], str]]:
    """Kinematics, kinetics and EMG of a reading with their captions; what was not recorded has no panel."""
    people = sorted({band.people for band in reading.bands.values()})
    bands = "No band: there is no reference for this condition."
    if people:
        count = str(people[0]) if people[0] == people[-1] else f"{people[0]} to {people[-1]}"
        at_speed = " at this person's speed" if any(band.at_speed for band in reading.bands.values()) else ""
        bands = (
            f"Bands: mean ± 1 (dark) and ± 2 (light) standard deviations over the legs{at_speed} (controls: {count}). "
            "A curve outside the bands may have no sentence: rules use single values and omit small differences."
        )
    muscles = emg_sheet(reading.pooled)
    return {
        "kinematics": (sheet(reading, KINEMATICS), f"{bands} {CYCLES}"),
        "kinetics": (sheet(reading, MOMENTS, POWERS, FORCES), MOMENT_SIGNS),
        "emg": (muscles, EMG + (RAW if any(panel.raw for panel in muscles) else "")),
    }


def _condition(reading: ClinicalReading, beside: Path, prefix: str, say: PageWords) -> dict[str, Any]:
    stem = next(iter(file_names([prefix]).values())) if prefix else ""
    words = {
        "where": name_walk(reading.pooled, say),
        "light": reading.light,
        "mark": LIGHT_MARKS[reading.light],
        "red": not reading.legs,
        "reasons": reading.reasons,
        "quality": quality_sentence(reading),
        "beside": " ".join(reading.beside),
        "outstanding": outstanding_sentences(reading, say),
        "scores": score_sentences(reading),
    }
    if not reading.legs:
        return words
    profile, sheets = profile_table(reading), list_sheets(reading)
    save_table(panel_numbers(sheets["kinematics"][0]), beside / f"{stem}cycles.csv")
    raw = raw_numbers(sheets["emg"][0])
    if len(raw):
        save_table(raw, beside / f"{stem}emg_raw.csv")
    return {
        **words,
        **{name: _sheet(*shown, beside, f"{stem}{name}", say) for name, shown in sheets.items()},
        "bars": Markup(profile_svg(reading.profile, say)) if reading.profile else "",
        "distances": _save(values_table(reading), beside, stem, say),
        "numbers": _save(numbers_table(reading), beside, stem, say),
        "profile": _save(profile, beside, stem, say) if profile else None,
    }


def _sheet(panels: list[Panel], caption: str, beside: Path, name: str, say: PageWords) -> dict[str, Any]:
    if panels:
        means = [replace(panel, lines=tuple(line for line in panel.lines if line.look != "single")) for panel in panels]
        save_table(panel_numbers(means), beside / f"{name}.csv")
    drawn = [{"panel": panel, "svg": Markup(svg(panel))} for panel in map(say.panel, panels)]
    return {"panels": drawn, "caption": caption, "file": f"{beside.name}/{name}.csv"}


def _save(table: Table, beside: Path, stem: str, say: PageWords) -> Table:
    save_table(table.numbers, beside / f"{stem}{table.name}.csv")
    return say.table(table)


def _contrast(contrast: Contrast, beside: Path, say: PageWords) -> dict[str, Any]:
    first, second = contrast.first.pooled.where, contrast.second.pooled.where
    stem = next(iter(file_names([f"{first}-{second}"]).values()))
    curves = _sheet(contrast_sheet(contrast), CONTRAST.format(*contrast.names), beside, f"{stem}-curves", say)
    changes = _save(change_table(contrast), beside, f"{stem}-", say)
    heading, sentences = contrast_heading(contrast, say), contrast_sentences(contrast)
    return {"heading": heading, "sentences": sentences, "curves": curves, "changes": changes}


def _reference(reference: ClinicalReference | None, condition: str) -> str:
    if reference is None:
        return "No reference."
    if reference.published:
        return ""  # its source stands among what the person is read beside
    count = reference.people(condition)
    people = f"{counted(count, 'control')} of the laboratory" if count else "no controls in this condition"
    return f"Reference: {people}, saved {reference.created[:10]}."


def _method(person: PersonSession) -> list[str]:
    method = []
    for reading in person.readings:
        pooled, where = reading.pooled, name_walk(reading.pooled)
        by = ", ".join(f"{name} ({counted(count, 'trial')})" for name, count in pooled.detectors.items())
        moved = pooled.contact_offset_s
        words = f", shifted by {1000 * moved:+.0f} ms (steps on a plate: {pooled.offset_steps})" if moved else ""
        method.append(f"{where}: contacts from {by or 'no detector'}{words}.")
        filters = dict.fromkeys(finding.what for finding in pooled.findings if finding.kind == "filter")
        method += [f"{where}: {words}; Butterworth filters, run forwards and backwards." for words in filters]
        method += {f"Angles by {finding.what}.": None for finding in pooled.findings if finding.kind == "marker set"}
    method.append("Pelvic obliquity is positive if the leg's side is up, and pelvic rotation if that side is forward.")
    method.append(
        "Each rule takes one value of a leg's mean cycle. □: outside mean ± 2 standard deviations of the reference. "
        "■: outside the prediction limits, which contain all values of a healthy person with probability 0.95 (t · sd"
        " · √(1 + 1/n), n people). With 10 controls or more, mean, limits and bands are those at this person's speed."
    )
    return method


def index_rows(person: PersonSession, name: str, say: PageWords = ENGLISH) -> list[dict[str, str]]:
    """Rows of the index for a person and session, with the name of the page."""
    rows = []
    for reading in person.readings:
        pooled = reading.pooled
        score = reading.profile.both if reading.profile else None
        tiers = [(MARKS[tier], write_noted(reading.noted, tier, say)) for tier in TIERS]
        first = [
            f"{mark} {sentences[0].partition(';')[0]}" + (f" (+{len(sentences) - 1})" if len(sentences) > 1 else "")
            for mark, sentences in tiers
            if sentences
        ]
        rows.append(
            {
                "light": reading.light,
                "subject": pooled.subject,
                "person": person.title,
                "condition": pooled.condition,
                "cycles": f"{pooled.counted('l')}, {pooled.counted('r')}",
                "score": number(score.value, 1) if score else NONE,
                "noted": "\n".join(first) or NONE if not reading.silent else NONE,
                "why": "; ".join(reading.reasons) or NONE,
                "page": f"people/{name}.html" if name else "",
            }
        )
    return rows


def write_index(
    run: StudyRun,
    rows: list[dict[str, str]],
    reference: ClinicalReference | None,
    folder: Path,
    say: PageWords = ENGLISH,
) -> Path:
    """Write `index.html`: a row a person, session and condition with its page's name, those without a result first."""
    known = {row["subject"] for row in rows}
    refused = [refusal for refusal in run.refusals if refusal.participant not in known]
    for refusal in refused:
        who = {"light": "red", "subject": refusal.participant, "person": refusal.participant, "page": ""}
        details = {"condition": refusal.condition or NONE, "why": refusal.reason}
        rows.append({**who, **details, **dict.fromkeys(("cycles", "score", "noted"), NONE)})
    rows = sorted(rows, key=lambda row: RANKS[row["light"]])
    cells = [tuple(row[key] for key in COLUMNS) for row in rows]
    table = words_table("people", "Participants of the run.", HEADINGS, cells)
    save_tables([table], folder)
    shown = {
        "say": say,
        "title": run.title,
        "created": run.provenance.created[:10],
        "rows": rows,
        "headings": HEADINGS,
        "whole": (folder / "report.html").is_file(),
        "lights": {light: sum(row["light"] == light for row in rows) for light in RANKS},
        "reference": _reference_words(reference),
        "people": counted(len({row["subject"] for row in rows}), "person").replace("persons", "people"),
    }
    return write_whole(folder / "index.html", page_text("people", shown))


def _reference_words(reference: ClinicalReference | None) -> str:
    if reference is None:
        return "No reference: the page has no bands, no scores and no comparison."
    if reference.published:
        return f"Published reference: {reference.title}."
    counts = ", ".join(f"{word} {reference.people(word)}" for word in reference.legs)
    return f"Reference: controls of the laboratory ({counts}), saved {reference.created[:10]}."
