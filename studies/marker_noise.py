"""Joint angles when skin moves over bone, and when markers are lost.

    python studies/marker_noise.py [DATA] [--out FOLDER] [--quick]

Bodies are real ones (a straight walk of HC030A with Plug-in Gait and Oxford foot markers, subject01 of gait10dof with
clusters of three): each marker is put where its segment, as followed in the recording, has it, so that the angles are
known. Skin: every marker slides on its segment in all three directions by sines of a stride's first two harmonics with
random phases, half of it in common with the markers of its segment; sizes are the root mean square in each direction on
the thigh, half of that on shank and pelvis, a quarter on the foot. Dropout: every marker of the real recording is lost
for 0.2 s at random times. Errors are root mean squares over frames, legs and draws [deg].
"""

from __future__ import annotations

from command_line import QUICK, RECORDINGS, argument, command_line

OUT = argument("--out", "folder of the picture; none is drawn without it")
GIVEN = command_line(__name__, __doc__, RECORDINGS, OUT, QUICK)  # before the slow imports

from pathlib import Path

import numpy as np
from markdown_table import markdown_table
from moved_markers import Body, bodies, lost, slid

import gaitdisc as gd

SIZES_MM, SHARES = (2.0, 5.0, 10.0, 15.0), (1, 5, 10, 20)
SHOWN = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "knee_adduction", "knee_rotation", "ankle_angle")


def errors(found: list[gd.Recording], truth: gd.Recording) -> dict[str, float]:
    """Root mean square error of each angle over both legs [deg]."""
    squares = {
        name: [(one[f"{name}_{side}"] - truth[f"{name}_{side}"]) ** 2 for one in found for side in "rl"]
        for name in SHOWN
    }
    return {name: float(np.sqrt(np.nanmean(each))) for name, each in squares.items()}


def skin(several: list[Body], draws: int) -> dict[tuple[str, float], dict[str, float]]:
    """Errors by body and size of sliding."""
    found = {}
    for body in several:
        truth = body.angles(body.rigid)
        for size in SIZES_MM:
            angles = [body.angles(slid(body, size, np.random.default_rng(seed))) for seed in range(draws)]
            found[body.name, size] = errors(angles, truth)
    return found


def dropout(several: list[Body], draws: int) -> dict[tuple[str, int], tuple[float, dict[str, float]]]:
    """Share of frames with all angles [%], and their errors against those with every marker, by body and share lost."""
    found = {}
    for body in several:
        truth = body.angles(body.markers)
        names = [f"{name}_{side}" for name in SHOWN for side in "rl"]
        for share in SHARES:
            angles = [body.angles(lost(body, share, np.random.default_rng(seed))) for seed in range(draws)]
            known = np.mean([np.isfinite(one.selected(names).values).mean() for one in angles])
            found[body.name, share] = (100 * float(known), errors(angles, truth))
    return found


def draw(slides: dict[tuple[str, float], dict[str, float]], folder: Path) -> None:
    """Error over size of sliding, one panel an angle, one line a set."""
    from matplotlib.figure import Figure

    folder.mkdir(parents=True, exist_ok=True)
    drawn = Figure(figsize=(12, 6), layout="constrained")
    places = drawn.subplots(2, 4).ravel()
    for place, angle in zip(places, SHOWN, strict=False):
        for name in dict.fromkeys(name for name, _ in slides):
            place.plot([0, *SIZES_MM], [0, *(slides[name, size][angle] for size in SIZES_MM)], marker="o", label=name)
        place.set(title=angle, xlabel="skin over the thigh, rms [mm]", ylabel="error, rms [deg]")
    places[0].legend(fontsize=7)
    places[-1].remove()
    drawn.savefig(folder / "marker_noise.png", dpi=90)


if __name__ == "__main__":
    several, draws = bodies(GIVEN.data), 2 if GIVEN.quick else 10
    slides = skin(several, draws)
    rows = [(*key[:1], f"{key[1]:g}", *map("{:.1f}".format, found.values())) for key, found in slides.items()]
    print(f"Skin that slides\n\n{markdown_table(' | '.join(('markers', 'thigh [mm]', *SHOWN)), rows)}")
    rows = [
        (*key, *map("{:.1f}".format, (known, *one.values()))) for key, (known, one) in dropout(several, draws).items()
    ]
    head = " | ".join(("markers", "lost [%]", "angles known [%]", *SHOWN))
    print(f"\nMarkers lost\n\n{markdown_table(head, rows)}")
    if GIVEN.out:
        draw(slides, Path(GIVEN.out))
