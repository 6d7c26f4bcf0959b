"""A body of rigid segments that moves by known joint angles, and the markers that a laboratory would see of it."""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from gaitdisc.channel import Channel
from gaitdisc.kinematics.pose import harrington_hip
from gaitdisc.recording import Recording, Source
from gaitdisc.recording.trial import BodyMeasures

WIDTH, DEPTH, THIGH, SHANK, HEIGHT = 0.24, 0.15, 0.40, 0.38, 0.07
RADIUS = 0.007
KNEE_WIDTH, ANKLE_WIDTH = 0.10, 0.07
MEASURES = BodyMeasures(
    marker_diameter_m=2 * RADIUS,
    knee_width_m={"l": KNEE_WIDTH, "r": KNEE_WIDTH},
    ankle_width_m={"l": ANKLE_WIDTH, "r": ANKLE_WIDTH},
)
ANGLES = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "knee_adduction", "knee_rotation",
          "ankle_angle", "ankle_inversion", "ankle_rotation")  # fmt: skip


@dataclass
class Laboratory:
    """Axes of the laboratory: columns are the walker's forward, up and right in them; a place of its origin."""

    axes: np.ndarray = field(default_factory=lambda: np.eye(3))
    origin: np.ndarray = field(default_factory=lambda: np.zeros(3))


def marker_places(sided: dict[str, dict[str, str]], pelvis: dict[str, str]) -> dict[str, dict[str, np.ndarray]]:
    """Markers in their segments' frames; `sided` and `pelvis` say which label lies on which place of `PLACES`."""
    body = {"pelvis": {label: pelvis_place(place) for place, label in pelvis.items()}}
    for side, sign in (("l", -1.0), ("r", 1.0)):
        for part, labels in sided.items():
            body[f"{part}_{side}"] = {
                label.replace("{S}", side.upper()): PLACES[part][place] * [1, 1, sign]
                for place, label in labels.items()
            }
    return body


def pelvis_place(place: str) -> np.ndarray:
    """Place of a pelvis marker from mid-ASIS."""
    return {
        "right": np.array([0, 0, WIDTH / 2]),
        "left": np.array([0, 0, -WIDTH / 2]),
        "sacrum": np.array([-DEPTH, 0, 0]),
        "right behind": np.array([-DEPTH, 0, 0.04]),
        "left behind": np.array([-DEPTH, 0, -0.04]),
    }[place]


KNEE_OUT, ANKLE_OUT = KNEE_WIDTH / 2 + RADIUS, ANKLE_WIDTH / 2 + RADIUS
PLACES = {  # of a right limb, in its frame: origin at the joint above
    "thigh": {
        "wand": np.array([0, -0.2, 0.12]),
        "front": np.array([0.07, -0.15, 0.02]),
        "rear": np.array([-0.06, -0.25, 0.05]),
        "lateral": np.array([0, -THIGH, KNEE_OUT]),
        "medial": np.array([0, -THIGH, -KNEE_OUT]),
    },
    "shank": {
        "wand": np.array([0, -0.2, 0.1]),
        "front": np.array([0.05, -0.1, 0.01]),
        "rear": np.array([-0.05, -0.15, 0.03]),
        "lateral": np.array([0, -SHANK, ANKLE_OUT]),
        "medial": np.array([0, -SHANK, -ANKLE_OUT]),
    },
    "foot": {
        "heel": np.array([-0.06, -0.04, 0.0]),
        "toe": np.array([0.14, -0.04, 0.0]),
        "inside": np.array([0.11, -0.03, -0.04]),
        "outside": np.array([0.11, -0.04, 0.04]),
        "top": np.array([0.05, 0.0, 0.0]),
    },
}

PLUG_IN_GAIT = marker_places(
    {
        "thigh": {"wand": "{S}THI", "lateral": "{S}KNE"},
        "shank": {"wand": "{S}TIB", "lateral": "{S}ANK"},
        "foot": {"heel": "{S}HEE", "toe": "{S}TOE"},
    },
    {"right": "RASI", "left": "LASI", "sacrum": "SACR"},
)
RAJAGOPAL = marker_places(
    {
        "thigh": {"wand": "{S}TH1", "front": "{S}TH2", "rear": "{S}TH3", "lateral": "{S}LFC", "medial": "{S}MFC"},
        "shank": {"wand": "{S}TB1", "front": "{S}TB2", "rear": "{S}TB3", "lateral": "{S}LMAL", "medial": "{S}MMAL"},
        "foot": {"heel": "{S}CAL", "toe": "{S}TOE", "outside": "{S}MT5"},
    },
    {"right": "RASI", "left": "LASI", "right behind": "RPSI", "left behind": "LPSI"},
)
GAIT2354 = marker_places(
    {
        "thigh": {"wand": "{S}.Thigh.Upper", "front": "{S}.Thigh.Front", "rear": "{S}.Thigh.Rear",
                  "lateral": "{S}.Knee.Lat", "medial": "{S}.Knee.Med"},
        "shank": {"wand": "{S}.Shank.Upper", "front": "{S}.Shank.Front", "rear": "{S}.Shank.Rear",
                  "lateral": "{S}.Ankle.Lat", "medial": "{S}.Ankle.Med"},
        "foot": {"heel": "{S}.Heel", "toe": "{S}.Toe.Tip", "top": "{S}.Midfoot.Sup", "outside": "{S}.Midfoot.Lat"},
    },
    {"right": "R.ASIS", "left": "L.ASIS", "sacrum": "V.Sacral"},
)  # fmt: skip
HELEN_HAYES = marker_places(
    {
        "thigh": {"wand": "{S}.Thigh", "lateral": "{S}.Knee", "medial": "{S}.Knee.Medial"},
        "shank": {"wand": "{S}.Shank", "lateral": "{S}.Ankle", "medial": "{S}.Ankle.Medial"},
        "foot": {"heel": "{S}.Heel", "toe": "{S}.Toe"},
    },
    {"right": "R.ASIS", "left": "L.ASIS", "sacrum": "V.Sacral"},
)
OXFORD_FOOT = marker_places(
    {
        "thigh": {"wand": "{S}THI", "lateral": "{S}KNE"},
        "shank": {"wand": "{S}TIB", "front": "{S}TUB", "rear": "{S}HFB", "lateral": "{S}ANK", "medial": "{S}MMA"},
        "foot": {"heel": "{S}HEE", "inside": "{S}P1M", "outside": "{S}P5M", "top": "{S}STL"},
    },
    {"right": "RASI", "left": "LASI", "sacrum": "SACR"},
)
SETS = {
    "plug_in_gait": PLUG_IN_GAIT,
    "rajagopal": RAJAGOPAL,
    "gait2354": GAIT2354,
    "helen_hayes": HELEN_HAYES,
    "oxford_foot": OXFORD_FOOT,
}


def known_angles(frames: int, seed: int = 0) -> dict[str, np.ndarray]:
    """Smooth angles of a walk [deg], with the package's names and signs, all three of each joint."""
    random = np.random.default_rng(seed)
    phase = np.linspace(0, 4 * np.pi, frames)
    sizes = {"hip_flexion": 25, "knee_angle": 30, "ankle_angle": 15}
    angles = {
        f"{name}_{side}": sizes.get(name, 6) * np.sin(phase + random.uniform(0, 6)) + random.uniform(-5, 5)
        for name in ANGLES
        for side in "rl"
    }
    for name, size in (("pelvis_tilt", 4), ("pelvis_list", 5), ("pelvis_rotation", 8)):
        angles[name] = size * np.sin(phase + random.uniform(0, 6))
    return angles


def standing() -> dict[str, np.ndarray]:
    """All angles zero, for a second at 100 Hz."""
    return {name: np.zeros(100) for name in known_angles(2)}


def body_frames(angles: dict[str, np.ndarray], speed: float = 1.3, rate_hz: float = 100.0):
    """Origin and rotation of each segment in the walker's frame, who goes forward at a speed [m/s]."""
    frames = len(angles["pelvis_tilt"])
    turns = np.stack([angles[f"pelvis_{name}"] for name in ("tilt", "list", "rotation")], axis=1)
    pelvis = Rotation.from_euler("ZXY", turns, degrees=True).as_matrix()
    origin = np.zeros((frames, 3))
    origin[:, 0] = speed * np.arange(frames) / rate_hz
    origin[:, 1] = 0.95
    found = {"pelvis": (origin, pelvis)}
    for side, sign in (("r", 1), ("l", -1)):
        above, place = pelvis, origin + pelvis @ harrington_hip(WIDTH, DEPTH, side)
        for part, names, flexion, length in (
            ("thigh", ANGLES[:3], 1, THIGH),
            ("shank", ANGLES[3:6], -1, SHANK),
            ("foot", ANGLES[6:], 1, 0.0),
        ):
            turns = np.stack([angles[f"{name}_{side}"] for name in names], axis=1) * [flexion, sign, sign]
            above = above @ Rotation.from_euler("ZXY", turns, degrees=True).as_matrix()
            found[f"{part}_{side}"] = (place, above)
            place = place + above @ np.array([0, -length, 0])
    return found


def markers_of(
    angles: dict[str, np.ndarray],
    body: dict[str, dict[str, np.ndarray]],
    laboratory: Laboratory | None = None,
    speed: float = 1.3,
    file: str = "walk.c3d",
) -> Recording:
    """Recording of the markers of a body in a laboratory."""
    laboratory = laboratory or Laboratory()
    channels, columns = [], []
    for segment, (origin, rotation) in body_frames(angles, speed).items():
        for label, place in body[segment].items():
            seen = (origin + rotation @ place) @ laboratory.axes.T + laboratory.origin
            columns.append(seen)
            channels += [Channel(f"{label}.{axis}", "marker", "m") for axis in "xyz"]
    values = np.concatenate(columns, axis=1)
    return Recording(np.arange(len(values)) / 100, values, tuple(channels), source=Source(file))


def static_of(body: dict[str, dict[str, np.ndarray]], laboratory: Laboratory | None = None) -> Recording:
    """Recording of the body standing."""
    return markers_of(standing(), body, laboratory, speed=0.0, file="static.c3d")


def without(recording: Recording, *markers: str) -> Recording:
    """Recording without some markers."""
    return recording.selected([name for name in recording.names if name.rpartition(".")[0] not in markers])


def renamed(recording: Recording, names: dict[str, str]) -> Recording:
    """Recording whose markers bear other names."""
    channels = tuple(
        channel.renamed(f"{names.get(channel.name[:-2], channel.name[:-2])}{channel.name[-2:]}")
        for channel in recording.channels
    )
    return Recording(recording.time, recording.values, channels, source=recording.source)
