"""What a simulation of one participant lacks: python studies/participant_discover.py P01 SIMULATION TRIALS."""

import sys

import gaitdisc as gd

person, simulation, trials = sys.argv[1:]
found, augmented = gd.discover(simulation, trials)
print(found.save(f"found/{person}"), found.sentence)
gd.write_simulation(augmented, f"found/{person}_augmented.toml")
