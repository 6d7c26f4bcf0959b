"""The cohort: twelve simulated walkers, their muscles, their walks, and a laboratory's files of them.

Imports ingest, signals, simulation and what is below them.
"""
