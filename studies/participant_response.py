"""What a device changes in one participant: python studies/participant_response.py P01 NOMINAL EXO."""

import sys

import gaitdisc as gd

person, nominal, exo = sys.argv[1:]
run = gd.fit_response(nominal, exo, outputs=["knee_angle_r", "ankle_angle_r"])
print(run.to_frame())
run.save(f"responses/{person}")  # `gaitdisc report responses/P01` draws its page
