"""Answers to cases, each a line of JSON in a file: a benchmark that was stopped goes on with what is not there."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any


def keep_answers(
    folder: Path, cases: Iterable[tuple[Any, ...]], answer: Callable[..., dict[str, Any]], fields: Sequence[str]
) -> list[dict[str, Any]]:
    """Answer each case that is not in folder/answers.jsonl, and return all answers there.

    answer: takes what a case consists of
    fields: of an answer, by which its case is known
    """
    path = folder / "answers.jsonl"
    folder.mkdir(parents=True, exist_ok=True)
    path.touch()
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    there = {tuple(line[field] for field in fields) for line in lines}
    for case in cases:
        if case not in there:
            lines.append(answer(*case))
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(lines[-1]) + "\n")
    return lines
