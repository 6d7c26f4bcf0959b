"""A saved result, read back; whether a recording is fit for use."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.library.walks import Walk, make_trial
from gaitdisc.processing.inspection import inspect_file, inspect_trial
from gaitdisc.saved.kind import find_kind

if TYPE_CHECKING:
    from gaitdisc.comparison.mismatch import Mismatch
    from gaitdisc.discovery.result import Discovery
    from gaitdisc.processing.inspection import Inspection
    from gaitdisc.processing.pooled_cycles import PooledCycles
    from gaitdisc.reconstruction.reconstruction import Reconstruction
    from gaitdisc.reconstruction.reconstructor import Reconstructor
    from gaitdisc.response.participant_response import ResponseRun
    from gaitdisc.response.variants import VariantRun


def load(
    folder: Path | str,
) -> ResponseRun | Discovery | Reconstruction | Mismatch | VariantRun | PooledCycles | Reconstructor:
    """Load a result that a command or `.save(folder)` wrote; changed files are refused.

    Parameters
    ----------
    folder : path
        Folder of the result: of `gaitdisc run`, `discover`, `compare`, `reconstruct`, or of a result's `save`.

    Returns
    -------
    ResponseRun, Discovery, Reconstruction, Mismatch, VariantRun, PooledCycles or Reconstructor
        The kind of result that the folder contains.

    Raises
    ------
    SchemaError
        If the folder contains no result, or if the result is damaged, incomplete or in a format that this version
        cannot read (docs/compatibility.md).

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.load("found").sentence  # doctest: +SKIP
    """
    return find_kind(Path(folder)).load(Path(folder))


def check(walk: Walk) -> Inspection:
    """Check a recording without changing or writing files.

    Parameters
    ----------
    walk : path, Trial, DataFrame or Recording
        A file of a walk, or the recording read from it.

    Returns
    -------
    Inspection
        `light` is `green`, `amber` (channels or samples are affected) or `red` (the file cannot be used; `refusal`
        gives the reason); `findings` lists all findings, the most severe first.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.check("walk.c3d").light  # doctest: +SKIP
    'green'
    """
    if isinstance(walk, Path | str):
        return inspect_file(Path(walk))
    trial = make_trial(walk)
    return inspect_trial(trial, trial.name)
