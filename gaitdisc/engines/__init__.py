"""Engines: models of OpenSim and MuJoCo, mapped, run, expanded along a record, and written back.

The only home of both engines. Imports simulation, saved results and what is below them.
"""
