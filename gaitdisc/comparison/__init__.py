"""Comparison: where two walks differ over the stride, by permutation tests, and the page that shows it.

Noun: `Mismatch`. Imports processing, report and what is below them.
"""
