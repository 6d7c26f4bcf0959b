"""A discovery on disk: `discovery.json`, the contract's keys first, then hashes; and the held-out runs as CSV."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.results.discovery import Discovery
from gaitdisc.results.sealed_json import file_sha256, sealed_text
from gaitdisc.spreadsheet import write_csv
from gaitdisc.whole_file import write_whole

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

    write_csv(pd.DataFrame(discovery.runs.table(discovery.channels)).dropna(), folder / RUNS, "%.8g")
    hashes = {RUNS: file_sha256(folder / RUNS)}
    return write_whole(folder / NAME, sealed_text({**discovery.to_json(), "sha256": hashes}))
