"""Processing: from the files of a trial to filtered cycles, and the page of these cycles.

Nouns: `Walk`, `PooledCycles`, `Inspection`. Imports kinetics, report and what is below them.
"""
