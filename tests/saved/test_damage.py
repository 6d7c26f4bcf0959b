"""Every kind of file of a run, damaged in every way that a disk or a hand does: refused in words, never a traceback."""

import contextlib
import json
import os
import random
import re
import shutil

import numpy as np
import pandas as pd
import pytest
from resealed import resealed
from texts import says

from gaitdisc.errors import GaitdiscError, SchemaError
from gaitdisc.processing.pooled_cycles import WALK
from gaitdisc.response.participant_response import QUANTITY, QUANTITY_COLUMNS, RESPONSE, DataQuantity, load_run
from gaitdisc.response.participants_result import OVER, TABLES, TESTS, OverParticipants, join_rows
from gaitdisc.response.variants import (
    VARIANT_COLUMNS,
    VARIANT_TEST_COLUMNS,
    VARIANTS,
    VariantRun,
    Variants,
    load_variant_run,
    save_variant_run,
)
from gaitdisc.run.run_study import REFUSED, Refused
from gaitdisc.saved.provenance import Refusal
from gaitdisc.saved.study_run import save_run
from gaitdisc.saved.unit_folder import damage_lines, unit_name

SEED, MUTATIONS = 11, 20
DEEP = "[" * 20_000
OTHER = (None, True, -1, 1e308, "x", [], {}, [[]], {"x": []})
LOAD = {
    "walks/P01-exo": WALK.load_keyed,
    "responses/P01": RESPONSE.load_keyed,
    "refused/P02": REFUSED.load_keyed,
    "quantities/P01": QUANTITY.load_keyed,
    "modalities/people/P01": VARIANTS.load_keyed,
    "modalities": load_variant_run,
    "tests": TESTS.load,
    "over": OVER.load,
    ".": load_run,
}


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    return tmp_path_factory.mktemp("whole")


@pytest.fixture
def folder(everything, run, pair_tests, tmp_path):
    """A run with a file of every kind."""
    if not (everything / "run.json").exists():
        over = OverParticipants(**{name: join_rows(name) for name in TABLES}, lengths_said="", responders_said="none")
        rows = pd.DataFrame([["60", 900, "knee", "exo", "network", "exo", 0.5, 100]], columns=list(QUANTITY_COLUMNS))
        quantity = DataQuantity("P01", "first", rows.astype({"length_s": float}), {240.0: "too long"})
        few = pd.DataFrame([["without EMG", "knee", "exo", "network", 0.5, 100]], columns=list(VARIANT_COLUMNS))
        variants = Variants("P01", "modalities", few, {"without EMG": "none"})
        no_tests = pd.DataFrame(columns=list(VARIANT_TEST_COLUMNS))
        varied = VariantRun("t", "exo", "modalities", (variants,), no_tests, (Refusal("P02", "", "short"),), (7.0, 8.0))
        WALK.save(run.walks[0], everything / "walks" / unit_name("P01", "exo"), "key")
        RESPONSE.save(run.responses[0], everything / "responses" / "P01", "key")
        REFUSED.save(Refused((Refusal("P02", "exo", "short"),), ("exo",)), everything / "refused" / "P02", "key")
        QUANTITY.save(quantity, everything / "quantities" / "P01", "key")
        VARIANTS.save(variants, everything / "modalities" / "people" / "P01", "key")
        save_variant_run(varied, everything / "modalities")
        OVER.save(over, everything / "over")
        save_run(
            run.with_units(TESTS, (pair_tests,)).with_units(OVER, (over,)).with_units(QUANTITY, (quantity,)), everything
        )
    return shutil.copytree(everything, tmp_path / "run")


def read(folder, place):
    """Load a unit, and look at the arrays that stay on the disk."""
    loaded = LOAD[place](folder / place)
    thing = loaded[0] if isinstance(loaded, tuple) else loaded
    for name in ("curves", "held_out", "residuals"):
        getattr(thing, name, None)


def mutated(content, chance):
    """Bytes with one thing wrong."""
    at = chance.randrange(len(content))
    return (
        content[:at],
        content[:at] + bytes([content[at] ^ (1 << chance.randrange(8))]) + content[at + 1 :],
        content[:at] + content[at + chance.randrange(1, 30) :],
        content[:at] + chance.randbytes(7) + content[at:],
        DEEP.encode(),
        b"",
        b"\xff\xfe\x00",
    )[chance.randrange(7)]


def test_the_whole_run_is_read(folder):
    for place in LOAD:
        read(folder, place)
    assert damage_lines(folder) == ()


@pytest.mark.parametrize("place", LOAD)
def test_damaged_bytes_are_refused_in_words(folder, place):
    chance = random.Random(SEED)
    for file in [path for path in (folder / place).iterdir() if path.is_file()]:
        whole = file.read_bytes()
        for _ in range(MUTATIONS):
            content = mutated(whole, chance)
            if content == whole:
                continue
            file.write_bytes(content)
            try:
                read(folder, place)
            except SchemaError as error:
                assert re.search(rf"{file.name} (is|has|lacks|cannot|does) .*`gaitdisc run` keeps", str(error))
                assert len(damage_lines(folder)) == 1
            else:  # of the JSON file, blanks between its words alone
                assert json.loads(content) == json.loads(whole)
        file.write_bytes(whole)


def spoilt(data, chance):
    """Change one value of a parsed file, at any depth, or take it out."""
    holder = data
    while True:
        key = chance.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
        if isinstance(holder[key], dict | list) and holder[key] and chance.random() < 0.6:
            holder = holder[key]
            continue
        if chance.random() < 0.3:
            del holder[key]
        else:
            holder[key] = chance.choice(OTHER)
        return


@pytest.mark.parametrize("place", LOAD)
def test_another_form_with_the_right_hash_is_refused_or_read(folder, place):
    chance = random.Random(SEED)
    [file] = (folder / place).glob("*.json")
    whole = file.read_text()
    for _ in range(3 * MUTATIONS):
        resealed(file, lambda data: spoilt(data, chance))
        with contextlib.suppress(GaitdiscError):  # anything else is a traceback
            read(folder, place)
        file.write_text(whole)


@pytest.mark.parametrize("place", LOAD)
def test_an_edited_number_or_word_is_found(folder, place):
    """A walk of 30 s that says 3 s, and every other value of every file."""
    [file] = (folder / place).glob("*.json")
    whole = json.loads(file.read_text())
    for key, value in whole.items():
        other = 3.0 if value != 3.0 else 4.0
        file.write_text(json.dumps({**whole, key: other}))
        with pytest.raises(SchemaError, match=r"\.json (is|has|cannot) "):
            read(folder, place)
        assert len(damage_lines(folder)) == 1


def test_a_run_of_before_the_hash_says_so(folder):
    for file in folder.rglob("*.json"):
        data = json.loads(file.read_text())
        del data["own_sha256"]
        file.write_text(json.dumps(data))
    with pytest.raises(SchemaError, match=r"run\.json.*version of gaitdisc"):
        load_run(folder)
    [line] = damage_lines(folder)
    assert line.startswith("modalities/people/P01/variants.json, ") and says(line, "5 more: has no hash of its own")


def test_a_pipe_in_the_place_of_a_file_is_not_waited_for(folder):
    (folder / "over" / "over.json").unlink()
    os.mkfifo(folder / "over" / "over.json")
    with pytest.raises(SchemaError, match=r"over\.json is missing"):
        OVER.load(folder / "over")


def test_arrays_that_change_after_the_unit_was_loaded_are_refused(folder):
    walk, _ = WALK.load_keyed(folder / "walks" / "P01-exo")
    np.savez(folder / "walks" / "P01-exo" / "arrays.npz", curves=np.zeros((4, 101, 2)))
    with pytest.raises(SchemaError, match=r"arrays\.npz.*changed since it was"):
        _ = walk.curves
