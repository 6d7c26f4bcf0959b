"""Saved results: `Kind` saves, loads and draws a noun; sealed folders, provenance, the units of a study run.

Knows no noun of a subject: each room registers its own kinds. Imports recordings and the ground.
"""
