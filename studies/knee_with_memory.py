"""A swinging leg whose knee remembers: how often hysteresis, a relaxing spring and a lagging moment are named.

    python studies/knee_with_memory.py [--seeds N] [--noise SHARE] [--quick]

The bundled swing leg, driven by sums of sines, with one thing hidden at its knee: hysteresis (Bouc-Wen), a spring in
series with a damper (Maxwell), a knee moment that acts through a first-order lag, or nothing. Numbers are drawn anew
for each seed; both angles are seen at 100 Hz with white noise. Four trials of 8 s, the last one held out.
"""

from __future__ import annotations

from command_line import QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("--seeds", "how often each is hidden", 5),
    argument("--noise", "standard deviation of the noise over that of each angle", 0.02),
    QUICK,
)  # before the slow imports

from dataclasses import replace

import numpy as np
from driven_trials import Driven, Sensed, recorded

import gaitdisc as gd

DRIVEN = Driven((9.0, 5.0), 0.3, 2.0, starts=(0.3, 2))
BENT = "(knee_rate - hip_rate)"
KINDS = ("hysteresis", "series_elasticity", "input_lag", "nothing")


def hidden(kind: str, rng: np.random.Generator) -> tuple[gd.Simulation, float]:
    """The leg with something hidden at its knee, and the number of its memory (yield, relaxation, lag)."""
    leg, stiffness = gd.bundled_simulation("swing_leg"), rng.uniform(15.0, 40.0)
    memory = float(rng.uniform(0.08, 0.25))
    rates = {"hysteresis": f"{BENT} - abs({BENT})*z/{memory}", "series_elasticity": f"{BENT} - z/{memory}"}
    z = replace(leg.states[0], name="z", meaning="", initial=0.0)
    if kind in rates:
        effect = gd.Term("knee_moment", "port", kind, f"-{stiffness}*z")
        return leg.with_state(z, rates[kind]).with_effect(effect), memory
    if kind == "input_lag":
        late = leg.with_state(replace(z, unit="N m"), "0").with_input("tau_knee", "z")
        return late.with_equation("z", f"(tau_knee - z)/{memory}"), memory
    return leg, float("nan")


def run(seeds: int, noise: float) -> list[str]:
    """Hide each, run discover, and count."""
    nominal, lines = gd.bundled_simulation("swing_leg").observing(["hip", "knee"]), []
    for kind in KINDS:
        right, errors, others = 0, [], []
        for seed in range(seeds):
            rng = np.random.default_rng([seed, KINDS.index(kind)])
            truth, memory = hidden(kind, rng)
            found, _ = gd.discover(nominal, recorded(truth, DRIVEN, Sensed(noise, channels=("hip", "knee")), rng))
            names = [one.name for one in found.effects]
            if names == ([] if kind == "nothing" else [kind]):
                right += 1
                last = list(found.effects[0].estimates.values())[-1].value if names else memory
                errors.append(abs(last / memory - 1))
            else:
                others.append(" and ".join(names) or "nothing")
        size = "" if kind == "nothing" or not errors else f", its memory to {100 * max(errors):.0f} % at worst"
        said = f"; said instead: {', '.join(others)}" if others else ""
        lines.append(f"{kind.replace('_', ' ')}: named in {right} of {seeds}{size}{said}")
    return lines


if __name__ == "__main__":
    print("\n".join(run(1 if GIVEN.quick else GIVEN.seeds, GIVEN.noise)))
