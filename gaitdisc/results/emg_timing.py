"""When muscles are active in normal walking: bars beneath envelopes of EMG."""

from __future__ import annotations

# [% of the cycle]; healthy adults at their own speed, about, after Perry J, Burnfield JM 2010, Gait Analysis: Normal
# and Pathological Function, 2nd ed.; children and other speeds differ.
NORMAL: dict[str, tuple[tuple[int, int], ...]] = {
    "gmax": ((0, 24), (95, 100)),
    "gmed": ((0, 29), (95, 100)),
    "tfl": ((0, 45),),
    "rf": ((56, 64),),
    "vas": ((0, 18), (86, 100)),
    "vasmed": ((0, 15), (90, 100)),
    "vaslat": ((0, 20), (86, 100)),
    "ham": ((0, 8), (80, 100)),
    "bf": ((0, 8), (82, 100)),
    "st": ((0, 4), (75, 100)),
    "sol": ((7, 52),),
    "gas": ((9, 50),),
    "gasmed": ((9, 50),),
    "gaslat": ((9, 50),),
    "ta": ((0, 12), (56, 100)),
    "tp": ((0, 55),),
    "per": ((15, 51),),
    "perl": ((15, 51),),
    "perb": ((15, 51),),
}
