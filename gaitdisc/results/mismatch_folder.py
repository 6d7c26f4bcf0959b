"""A mismatch on disk: `mismatch.json`, tables as CSV, curves as NPZ; every file hashed."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.results.mismatch import CHANNEL_COLUMNS, REGION_COLUMNS, Alignment, Exchange, Mismatch
from gaitdisc.results.provenance import Provenance
from gaitdisc.results.unit_folder import load_unit, save_unit, stored_finding

NAME = "mismatch.json"
TABLES = {"regions.csv": REGION_COLUMNS, "summary.csv": CHANNEL_COLUMNS}


def save_mismatch(mismatch: Mismatch, folder: Path) -> None:
    """Save a mismatch."""
    save_unit(
        folder,
        NAME,
        {
            "first": mismatch.first,
            "second": mismatch.second,
            "channels": [asdict(channel) for channel in mismatch.channels],
            "exchange": asdict(mismatch.exchange),
            "alignment": asdict(mismatch.alignment),
            "findings": [asdict(finding) for finding in mismatch.findings],
            "provenance": asdict(mismatch.provenance),
        },
        {"regions.csv": mismatch.regions, "summary.csv": mismatch.summary},
        dict(mismatch.curves),
    )


def load_mismatch(folder: Path) -> Mismatch:
    """Load a mismatch."""
    data, tables, arrays = load_unit(folder, NAME, TABLES)
    regions, summary = (pd.DataFrame(tables[name], columns=pd.Index(columns)) for name, columns in TABLES.items())
    return Mismatch(
        data["first"],
        data["second"],
        tuple(Channel(**channel) for channel in data["channels"]),
        dict(arrays),
        regions,
        summary,
        Exchange(**data["exchange"]),
        tuple(map(stored_finding, data["findings"])),
        Provenance(**data["provenance"]),
        Alignment(**data.get("alignment", {})),
    )
