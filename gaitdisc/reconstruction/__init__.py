"""Reconstruction (chapter 5): the full state from a few sensors and their history, on splits that do not leak.

Nouns: `Reconstructor`, `Reconstruction`. Imports processing, models, report and what is below them.
"""
