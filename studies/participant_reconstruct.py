"""All angles of one participant from a few: python studies/participant_reconstruct.py P01 WALK SENSOR [SENSOR ...]."""

import sys

import gaitdisc as gd

person, walk, *sensors = sys.argv[1:]
angles = gd.lowpass(gd.read(walk).stream("kinematics")).to_pandas()
readings, states, fitted = angles[sensors], angles.drop(columns=sensors), int(0.8 * len(angles))
model = gd.Reconstructor("delay ridge").fit(readings[:fitted], states[:fitted])
print(model.save(f"models/{person}"), f"R2 held out: {model.score(readings[fitted:], states[fitted:]):.3f}")
