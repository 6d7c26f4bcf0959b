"""Edit a JSON file of results as somebody would who knows how its own hash is made."""

import json

from gaitdisc.saved.unit_folder import OWN, seal_text


def resealed(path, change):
    """Give the parsed file to `change`, which changes it in place, and write it with the right hash."""
    data = json.loads(path.read_text(encoding="utf-8"))
    data.pop(OWN)
    change(data)
    path.write_text(seal_text(data), encoding="utf-8")
