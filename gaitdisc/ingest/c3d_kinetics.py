"""Forces, moments and powers of a model in a C3D file: per kg or not, of the muscles or of the load."""

import re
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.ingest.stated_units import LEG_MOMENT
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values, finite_values
from gaitdisc.recording.trial import MASS_KG

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


@dataclass(frozen=True)
class Evidence:
    """What shows whether kinetics are divided by body mass."""

    per_kg: bool | None
    words: str = ""
    certain: bool = False  # whether plates and reaction forces were compared
    mass_kg: float | None = None  # plate over reaction force, where both saw one step


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
        mass = f" (body mass {shown.mass_kg:.1f} kg)" if shown.mass_kg else ""
        what = (
            f"{shown.words}; forces, moments and powers (channels: {count}) are therefore read in N/kg, N m/kg and W/kg"
            f"{mass}, contrary to the units in the file"
        )
        spoils = "" if shown.certain else "joint moments and powers if this is wrong; state the unit in the file"
        findings.append(Finding("note" if shown.certain else "warning", "per body mass", file, what, spoils))
        channels = tuple(replace(c, unit=_PER_KG.get(c.unit, c.unit)) for c in channels)
    elif wrong and (reaction.per_kg, joints.per_kg) in ((True, False), (False, True)):
        what = f"{reaction.words}, but {joints.words} N m; the units of the file are used"
        findings.append(Finding("warning", "per body mass", file, what, "forces, moments and powers; correct the file"))
    if shown.mass_kg and mass_kg and abs(shown.mass_kg / mass_kg - 1) > AGREES:
        what = f"the plates show a body mass of {shown.mass_kg:.1f} kg, but the file states {mass_kg:.1f} kg"
        findings.append(Finding("warning", "body mass", file, what, "results per kg of body mass; correct the mass"))
    of_weight = [c.name for c in channels if _NORMALISED.fullmatch(c.name) and c.unit != "%"]
    if of_weight:
        channels = tuple(replace(c, unit="%") if c.name in of_weight else c for c in channels)
        what = f"read in percent of body weight: {', '.join(of_weight[:2])}{', ...' * (len(of_weight) > 2)}"
        findings.append(Finding("note", "per body mass", file, what, ""))
    kinetics, more = _internal((values, channels), file)
    return kinetics, findings + more


def _by_plates(values: Values, channels: tuple[Channel, ...], plates_n: Values) -> Evidence | None:
    """Ratio of a plate's force to a foot's reaction force, where it is the same over a step."""
    for side in "LR":
        columns = [i for i, c in enumerate(channels) if _REACTION.fullmatch(c.name) and c.name[0] == side]
        if len(columns) != 3 or len(values) != len(plates_n):
            continue
        foot = np.linalg.norm(values[:, columns], axis=1)
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


def _by_size(values: Values, channels: tuple[Channel, ...], pattern: re.Pattern[str], quantity: str) -> Evidence:
    columns = [i for i, c in enumerate(channels) if pattern.fullmatch(c.name) and c.unit in _PER_KG]
    sizes = finite_values(np.abs(values[:, columns]))
    most = float(np.quantile(sizes, 0.995)) if sizes.size else 0.0
    if most == 0:
        return Evidence(None)
    words = f"no {'reaction force' if quantity == 'force' else 'joint moment of a leg'} exceeds {most:.3g}"
    if most > PER_KG_AT_MOST[quantity]:
        return Evidence(False, words.replace("no ", "a ").replace("exceeds", "reaches"))
    return Evidence(True, words)


def _internal(kinetics: Kinetics, file: str) -> tuple[Kinetics, list[Finding]]:
    """Joint moments positive towards the positive angle, by the sign that the ankle's has at push-off."""
    values, channels = kinetics
    joints = [i for i, c in enumerate(channels) if c.quantity == "moment" and not _OF_GROUND.match(c.name)]
    if not joints:
        return kinetics, []
    ankles = [i for i in joints if _ANKLE.fullmatch(channels[i].name) and channels[i].unit in PUSH_OFF]
    moments = finite_values(values[:, ankles])
    how = "joint moments are internal (of the muscles), positive in the angle's positive direction"
    words, why = "no ankle moment shows the sign", ", which is assumed to be that of Plug-in Gait"
    spoils = "the sign of joint moments if the file comes from another model"
    if moments.size:
        unit = channels[ankles[0]].unit
        low, high = np.quantile(moments, [0.005, 0.995])
        words = f"ankle moments range from {low:.2f} to {high:.2f} {unit}"
        up, down = moments[moments > 0].sum(), -moments[moments < 0].sum()
        if high > PUSH_OFF[unit] and up > ONE_SIDED * down:
            why, spoils = ": positive is plantarflexion", ""
        elif -low > PUSH_OFF[unit] and down > ONE_SIDED * up:
            what = f"{words}: plantarflexion is already negative; {how}"
            return kinetics, [Finding("note", "moment sign", file, what, "")]
        else:
            words += ", without a push-off"
    signs = np.ones(len(channels))
    signs[joints] = -1.0
    what = f"{words}{why}; the sign of the joint moments (channels: {len(joints)}) was reversed, so that {how}"
    return (values * signs, channels), [Finding("note", "moment sign", file, what, spoils)]
