"""Libraries of chapter 3 that do not come with the plain package: needed where they are used."""

from __future__ import annotations

import importlib
import warnings
from types import ModuleType

from gaitdisc.errors import TrainingError


def chapter3_library(name: str) -> ModuleType:
    """Library of the extra `chapter3`."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of optional parts of theirs that are not used here
            return importlib.import_module(name)
    except ImportError as error:
        raise TrainingError(
            f"this method needs the library {name}",
            f"it cannot be imported ({error})",
            "Install the extra: pip install 'gaitdisc[chapter3]'.",
        ) from error
