"""People that the package makes itself; for now two small driven walkers, behind `gaitdisc demo`."""
