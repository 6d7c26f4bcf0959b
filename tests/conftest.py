"""Where real recordings lie, and the skip where they do not."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

# An example may take as long as it does: no test rests on how busy this machine is.
settings.register_profile("no clock", deadline=None)
settings.load_profile("no clock")

PROJECT = Path(__file__).parents[1]


@pytest.fixture(scope="session")
def gait_data() -> Path:
    """Folder of real gait recordings: ../shared/data/gait, or GAITDISC_DATA/gait."""
    data = Path(os.environ.get("GAITDISC_DATA", PROJECT.parent / "shared" / "data"))
    folder = data / "gait"
    if not folder.is_dir():
        pytest.skip(f"real recordings are absent: {folder} (set GAITDISC_DATA)")
    return folder


@pytest.fixture
def trained_briefly(monkeypatch):
    """Networks take two passes over their samples: for tests of what is made of a network, not of what it learns.

    In this process only: one that is started beside it trains whole.
    """
    monkeypatch.setattr("gaitdisc.networks.training_settings.epochs_of", lambda *_: 2)


@pytest.fixture
def unpainted(monkeypatch):
    """Figures are laid out and not painted, most of the time of a report: for tests of what a page says."""
    monkeypatch.setattr("gaitdisc.report.figure._svg", lambda _: b"<svg/>")
    monkeypatch.setattr("gaitdisc.report.figure._png", lambda _: b"")
