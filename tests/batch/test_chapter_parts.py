import re

import pytest

from gaitdisc.batch.chapter_parts import CHAPTERS, OUT, PARTS, costs, parts_of, studies_folder
from gaitdisc.errors import SchemaError


def test_every_part_has_its_study_and_the_words_that_it_takes():
    for part in PARTS:
        text = (studies_folder() / f"{part.study}.py").read_text(encoding="utf-8")
        for word in (*part.words, *part.quick_words):
            if word.startswith("--"):
                assert re.search(rf"\[{word}\b", text), (part.name, word)  # as the first lines of the file show it
        assert OUT in part.words or part.name == "tables"
        assert part.quick_minutes <= part.minutes


def test_no_two_parts_share_a_folder():
    names = [part.name for part in PARTS]
    assert len(set(names)) == len(names)


def test_every_study_of_a_chapter_is_a_part_or_is_used_by_one():
    texts = {path.stem: path.read_text(encoding="utf-8") for path in studies_folder().glob("ch[345]_*.py")}
    named = {part.study for part in PARTS}
    for study in set(texts) - named:
        assert any(f"from {study} import" in texts[name] for name in texts if name != study), study


def test_the_parts_of_a_chapter():
    assert [part.name for part in parts_of(5, "turbulence")] == ["turbulence"]
    assert sum(len(parts_of(chapter)) for chapter in CHAPTERS) == len(PARTS)
    for name in (part.name for part in PARTS):
        assert f" {name}: " in costs()


def test_what_is_no_part_is_refused_with_the_nearest():
    with pytest.raises(SchemaError, match=r"'van_der_poll'.*'van_der_pol'"):
        parts_of(3, "van_der_poll")
    with pytest.raises(SchemaError, match=r"chapters 3, 4, 5.*6"):
        parts_of(6)
