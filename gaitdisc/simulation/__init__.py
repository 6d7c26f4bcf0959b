"""Simulation: the simulation file, read, checked, compiled, run, given effects and written back.

Nouns: `Simulation`, `Term`, `Trials`. Imports recordings and the ground.
"""
