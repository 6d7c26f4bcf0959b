"""Chapter 5: the full state from a few sensors and their history, judged by splits that do not leak."""
