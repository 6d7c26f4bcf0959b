"""Chapter 5: the full state from a few sensors and their history, tested on splits that do not leak."""
