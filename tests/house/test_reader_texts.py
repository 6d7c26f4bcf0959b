"""The list of texts that a user reads has every kind, and each of its texts stands where it says."""

import importlib.util

from budget import CHECKOUT

SPEC = importlib.util.spec_from_file_location("reader_texts", CHECKOUT / "benchmarks" / "reader_texts.py")
KINDS = {"refusal", "finding", "sentence", "page", "help", "docs", "docstring"}


def test_every_kind_is_listed_with_its_place():
    SPEC.loader.exec_module(module := importlib.util.module_from_spec(SPEC))
    texts = module.list_texts()
    stride = next(text for text in texts if text.text.startswith("a stride must have two initial contacts"))
    path, _, line = stride.place.partition(":")
    assert (CHECKOUT / path).read_text().splitlines()[int(line) - 1].strip() == "raise StrideError("
    assert stride.kind == "refusal" and {text.kind for text in texts} == KINDS
