"""Ingest: files of a gait laboratory become trials, converted once to the units used inside.

C3D, `.mot`, `.sto`, `.trc`, tables, arrays, and the study file. Identifiers stop here.
Imports recordings and the ground.
"""
