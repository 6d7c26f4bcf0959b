"""Runs: many participants, one after another or side by side, resumed, one run at a time in a folder; chapters.

Imports the subjects (response, clinic and their neighbours) and what is below them.
"""
