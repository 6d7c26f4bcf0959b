"""Forces, moments and powers of a model in a C3D file, per kg or not; and the person's mass, lengths and widths."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.ingest.c3d_parameters import C3DParameters, read_c3d_header, read_c3d_parameters
from gaitdisc.ingest.stated_units import LEG_MOMENT
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.trial import LENGTHS_M, MASS_KG, BodyMeasures

Kinetics = tuple[Values, tuple[Channel, ...]]

LOADED_N = 100.0  # a plate that carries a foot
LOADED_PER_KG = 2.0  # a reaction force that is no noise, in N/kg; in N it is that all the more
STEADY = 0.05  # spread of the ratio of plate to reaction force over a step that both saw
AGREES = 0.05  # of a mass
PER_KG_AT_MOST = {"force": 40.0, "moment": 10.0}  # N/kg, four body weights; N m/kg: no joint of a walking leg
PUSH_OFF = {"N m/kg": 0.4, "N m": 12.0}  # least ankle moment of a push-off; standing has less
ONE_SIDED = 2.0  # impulse of the ankle's larger side over that of the other
_PER_KG = {"N": "N/kg", "N m": "N m/kg", "W": "W/kg"}
_REACTION = re.compile(r"[LR]GroundReactionForce\.[xyz]")
_NORMALISED = re.compile(r"[LR]NormalisedGRF\.[xyz]")
_ANKLE = re.compile(r"ankle_angle_[rl]_moment")
_OF_GROUND = re.compile(r"[LR]?Ground")
GROUPS = ("PROCESSING", "SUBJECTS", "SUBJECT")
OF_THE_BODY = {
    "height_m": ("HEIGHT", "BODYHEIGHT"),
    "inter_asis_m": ("INTERASISDISTANCE", "ASISDISTANCE"),
    "marker_diameter_m": ("MARKERDIAMETER",),
}
OF_A_SIDE = {"leg_length_m": ("LEGLENGTH",), "knee_width_m": ("KNEEWIDTH",), "ankle_width_m": ("ANKLEWIDTH",)}
FACTORS = (1e-3, 1.0, 1e-2)  # mm, as Nexus writes; m; cm: the first that makes it a length of a person


@dataclass(frozen=True)
class Evidence:
    """What shows whether kinetics are divided by body mass."""

    per_kg: bool | None
    words: str = ""
    certain: bool = False  # whether plates and reaction forces were compared
    mass_kg: float | None = None  # plate over reaction force, where both saw one step


def body_mass(parameters: C3DParameters) -> float | None:
    """Body mass that the file states [kg], or None."""
    for group, name in (("PROCESSING", "BODYMASS"), ("SUBJECTS", "BODYMASS"), ("SUBJECT", "WEIGHT")):
        mass = parameters.number(group, name)
        if mass is not None and MASS_KG.hold(mass):
            return mass
    return None


def house_kinetics(
    kinetics: Kinetics, plates_n: Values, mass_kg: float | None, file: str
) -> tuple[Kinetics, list[Finding]]:
    """Kinetics of a model in their true unit and with the package's sign: internal, positive as the angle is.

    Plug-in Gait divides forces, moments and powers by body mass and states N, N mm and W. A reaction force that stays
    in one ratio to a plate shows it, and which mass it was; without a plate the size of the numbers does. Nothing is
    multiplied: the unit becomes N/kg, N m/kg, W/kg, and % for the reaction force in percent of body weight.

    Its joint moments are those of the load on the joint: at push-off the ankle's is positive, where a moment of the
    muscles towards dorsiflexion is negative. The ankle's impulse shows which of the two a file holds.

    kinetics (values, channels): stream `moments`, (frame, channel) [N, N m, W as the file states]
    plates_n (frame, plate) [N]: size of the force of each plate; no column where there is none
    Source: Vicon, Plug-in Gait Reference Guide: kinetic outputs are normalised by body mass.
    """
    values, channels = kinetics
    reaction = _by_plates(values, channels, plates_n) or _by_size(values, channels, _REACTION, "force")
    joints = _by_size(values, channels, LEG_MOMENT, "moment")
    shown = reaction if reaction.per_kg is not None else joints
    findings = []
    wrong = [c.name for c in channels if c.unit in _PER_KG]
    if wrong and shown.per_kg and joints.per_kg is not False:
        count = len(wrong)
        mass = f", {shown.mass_kg:.1f} kg" if shown.mass_kg else ""
        what = (
            f"{shown.words}; {count} forces, moments and powers are therefore per kg of body mass{mass}, contrary to "
            "the unit in the file; given in N/kg, N m/kg and W/kg"
        )
        spoils = "" if shown.certain else "joint moments and powers if this is wrong; state the unit in the file"
        findings.append(Finding("note" if shown.certain else "warning", "per body mass", file, what, spoils))
        channels = tuple(replace(c, unit=_PER_KG.get(c.unit, c.unit)) for c in channels)
    elif wrong and (reaction.per_kg, joints.per_kg) in ((True, False), (False, True)):
        what = f"{reaction.words}, but {joints.words} N m; the units are those of the file"
        findings.append(Finding("warning", "per body mass", file, what, "forces, moments and powers; correct the file"))
    if shown.mass_kg and mass_kg and abs(shown.mass_kg / mass_kg - 1) > AGREES:
        what = f"the plates show a body mass of {shown.mass_kg:.1f} kg, the file states {mass_kg:.1f} kg"
        findings.append(Finding("warning", "body mass", file, what, "everything that depends on body mass; correct it"))
    of_weight = [c.name for c in channels if _NORMALISED.fullmatch(c.name) and c.unit != "%"]
    if of_weight:
        channels = tuple(replace(c, unit="%") if c.name in of_weight else c for c in channels)
        what = f"{', '.join(of_weight[:2])}{', ...' * (len(of_weight) > 2)} are in percent of body weight"
        findings.append(Finding("note", "per body mass", file, what, ""))
    kinetics, more = _internal((values, channels), file)
    return kinetics, findings + more


def _by_plates(values: Values, channels: tuple[Channel, ...], plates_n: Values) -> Evidence | None:
    """Ratio of a plate's force to a foot's reaction force, where it is the same over a step."""
    for side in "LR":
        own = [i for i, c in enumerate(channels) if _REACTION.fullmatch(c.name) and c.name[0] == side]
        if len(own) != 3 or len(values) != len(plates_n):
            continue
        foot = np.linalg.norm(values[:, own], axis=1)
        for place, plate in enumerate(plates_n.T, 1):
            both = (foot > LOADED_PER_KG) & (plate > LOADED_N)
            if both.sum() < 10:
                continue
            low, ratio, high = np.quantile(plate[both] / foot[both], [0.1, 0.5, 0.9])
            if high - low > 2 * STEADY * ratio:
                continue
            at = int(np.argmax(np.where(both, plate, 0)))
            words = f"plate {place} carries {plate[at]:.0f} N when {side}GroundReactionForce is {foot[at]:.4g}"
            if abs(ratio - 1) <= AGREES:
                return Evidence(False, words, True)
            if MASS_KG.hold(ratio):
                return Evidence(True, words, True, float(ratio))
    return None


def _by_size(values: Values, channels: tuple[Channel, ...], wanted: re.Pattern[str], quantity: str) -> Evidence:
    own = [i for i, c in enumerate(channels) if wanted.fullmatch(c.name) and c.unit in _PER_KG]
    sizes = np.abs(values[:, own])
    sizes = sizes[np.isfinite(sizes)]
    most = float(np.quantile(sizes, 0.995)) if sizes.size else 0.0
    if most == 0:
        return Evidence(None)
    words = f"no {'reaction force' if quantity == 'force' else 'joint moment of a leg'} exceeds {most:.3g}"
    if most > PER_KG_AT_MOST[quantity]:
        return Evidence(False, words.replace("no ", "a ").replace("exceeds", "reaches"))
    return Evidence(True, words)


def _internal(kinetics: Kinetics, file: str) -> tuple[Kinetics, list[Finding]]:
    values, channels = kinetics
    joints = [i for i, c in enumerate(channels) if c.quantity == "moment" and not _OF_GROUND.match(c.name)]
    if not joints:
        return kinetics, []
    sense, words = _push_off(values, channels)
    how = "joint moments are internal (of the muscles), positive towards the positive angle"
    if sense < 0:
        what = f"{words}: plantarflexion is already negative; {how}"
        return kinetics, [Finding("note", "moment sign", file, what, "")]
    signs = np.ones(len(channels))
    signs[joints] = -1.0
    why = words + ": positive is plantarflexion" if sense else f"{words}; interpreted as in Plug-in Gait"
    what = f"{why}; the sign of {len(joints)} joint moments is reversed, {how}"
    spoils = "" if sense else "the sign of joint moments if the file comes from another model"
    return (values * signs, channels), [Finding("note", "moment sign", file, what, spoils)]


def _push_off(values: Values, channels: tuple[Channel, ...]) -> tuple[int, str]:
    """+1 where the ankle's moment is positive at push-off, -1 where it is negative, 0 where none is seen."""
    ankles = [i for i, c in enumerate(channels) if _ANKLE.fullmatch(c.name) and c.unit in PUSH_OFF]
    moments = values[:, ankles]
    moments = moments[np.isfinite(moments)]
    if not moments.size:
        return 0, "no ankle moment shows the sign"
    unit = channels[ankles[0]].unit
    low, high = np.quantile(moments, [0.005, 0.995])
    words = f"ankle moments range from {low:.2f} to {high:.2f} {unit}"
    up, down = moments[moments > 0].sum(), -moments[moments < 0].sum()
    if high > PUSH_OFF[unit] and up > ONE_SIDED * down:
        return 1, words
    if -low > PUSH_OFF[unit] and down > ONE_SIDED * up:
        return -1, words
    return 0, f"{words}, without a push-off"


def read_body_measures(path: Path | str) -> BodyMeasures:
    """Measures of the person in PROCESSING, SUBJECTS or SUBJECT; none where absent, zero, or not in mm, m or cm."""
    return find_body_measures(read_c3d_parameters(path, read_c3d_header(path)))


def body_measures_in(path: Path) -> BodyMeasures:
    """Measures of the person in a file, if it is a C3D file; no other kind has any."""
    return read_body_measures(path) if path.suffix.lower() == ".c3d" else BodyMeasures()


def find_body_measures(parameters: C3DParameters) -> BodyMeasures:
    """Measures of the person that stand in parameters."""
    whole = {name: _length(parameters, name, keys) for name, keys in OF_THE_BODY.items()}
    sided = {}
    for name, keys in OF_A_SIDE.items():
        lengths = {side: _length(parameters, name, [f"{side.upper()}{key}" for key in keys]) for side in "lr"}
        sided[name] = {side: length for side, length in lengths.items() if length is not None}
    return BodyMeasures(body_mass(parameters), **whole, **sided, source=parameters.file)


def _length(parameters: C3DParameters, name: str, keys: Sequence[str]) -> float | None:
    for group in GROUPS:
        for key in keys:
            number = parameters.number(group, key)
            for factor in FACTORS:
                if number is not None and LENGTHS_M[name].hold(number * factor):
                    return round(number * factor, 9)
    return None
