"""A discovery on disk: `discovery.json`, the contract's keys first, and the held-out runs as CSV."""

from __future__ import annotations

import json
from pathlib import Path

from gaitdisc.results.discovery import Discovery
from gaitdisc.whole_file import whole_file, write_whole

NAME = "discovery.json"
RUNS = "held_out.csv"


def save_discovery(discovery: Discovery, folder: Path) -> Path:
    """Save a discovery.

    Parameters
    ----------
    discovery : Discovery
        What was found.
    folder : Path
        Where; made if missing.

    Returns
    -------
    Path
        Its JSON file.

    Raises
    ------
    WriteError
        If a file cannot be written; what stood there before still stands.
    """
    import pandas as pd

    with whole_file(folder / RUNS) as part:
        table = pd.DataFrame(discovery.runs.table(discovery.channels)).dropna()
        table.to_csv(part, index=False, lineterminator="\n", float_format="%.8g")
    content = json.dumps(discovery.to_json(), indent=2, allow_nan=False, ensure_ascii=False)
    return write_whole(folder / NAME, content + "\n")
