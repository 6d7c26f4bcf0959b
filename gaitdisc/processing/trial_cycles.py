"""Cycles of one trial: each with its events, what a plate saw of it, where the feet were, and why it is left out."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gaitdisc.channel import Channel, other_side, vocabulary
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study import LEFT_OUT_CYCLE, Filters
from gaitdisc.kinematics.markers import PATH_S, STRAIGHT_DEG
from gaitdisc.kinematics.pose import clinical_angles
from gaitdisc.kinetics.plate_steps import PlateStep
from gaitdisc.processing.process import is_raw, make_envelope
from gaitdisc.processing.step_events import Timed, trial_markers
from gaitdisc.processing.walk_pair import FORCE_HZ
from gaitdisc.recording import Cycle, Finding, Recording, Trial
from gaitdisc.recording.arrays import Span, Values, finite_values, runs
from gaitdisc.recording.recording import join_recordings
from gaitdisc.recording.strides import NAN, interpolate
from gaitdisc.recording.wrapping import unwrap
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.channel_quality import plateau_marked
from gaitdisc.signals.contacts import RISE_N, loaded
from gaitdisc.signals.direction import Direction, marker_position
from gaitdisc.signals.emg import live_channels
from gaitdisc.signals.gaps import fill_gaps, without_spikes
from gaitdisc.signals.strides import gap_reasons

Loadings = Mapping[str, Sequence[Span]]
LONGEST_STANCE = 0.8  # of a stride: a plate that is loaded for longer carried two feet
SHORTEST_STRIDE_M = 0.1  # below it the line of a stride has no direction
SAME_START_S = 0.1  # by which the start that a study gives of a cycle may differ
EDGE_S = 0.06  # by which markers and a plate may differ about one event
LEGS = ("hip_", "knee_", "ankle_", "subtalar_")
BELT_RISE = 0.1  # of a foot's largest force, above which its own force is there
LOADED_PERCENT = 10.0  # of body weight: the foot is on the plate
# Plug-in Gait: tilt positive forwards, obliquity positive with the named side up, rotation with it forwards.
PLUG_IN_GAIT = {
    "pelvis_tilt": ("RPelvisAngles.x", -1.0),
    "pelvis_list": ("LPelvisAngles.y", 1.0),
    "pelvis_rotation": ("RPelvisAngles.z", 1.0),
    "foot_progression_angle_r": ("RFootProgressAngles.z", 1.0),
    "foot_progression_angle_l": ("LFootProgressAngles.z", 1.0),
}


@dataclass(frozen=True)
class Places:
    """Where the feet were in one cycle."""

    step_s: float = NAN  # from the contact of the other foot to the next of this one [s]
    stride_m: float = NAN  # lengths [m]; NaN without markers
    step_m: float = NAN  # from where the other heel landed inside of the cycle to where this one lands at its end
    width_m: float = NAN  # how far beside the line of the stride the other landed


def cut_cycles(contacts: Timed, offs: Timed) -> list[Cycle]:
    """Cycles from each contact to the next of the same foot, with the events inside.

    Left out is a cycle that has no contact of the other foot inside, or more than one, where the contacts of the other
    foot were seen before and after.

    >>> contacts = {"r": ((0.0, "force"), (1.0, "force")), "l": ((0.5, "force"),)}
    >>> one = cut_cycles(contacts, {"r": ((0.6, "force"),), "l": ((0.1, "force"),)})[0]
    >>> one.foot_off, one.opposite_off, one.opposite_contact, one.reason
    (0.6, 0.1, 0.5, '')
    """
    cycles = []
    for side, times in sorted(contacts.items()):
        other = other_side(side)
        across = [at for at, _ in contacts.get(other, ())]
        for (start, by), (end, next_by) in itertools.pairwise(times):
            length = end - start
            off, off_by = _first(offs.get(side, ()), start + 0.2 * length, start + 0.95 * length)
            inside = [at for at in across if start < at < end]
            landed = inside[0] if len(inside) == 1 else NAN
            until = landed if inside else start + 0.5 * length
            lift, _ = _first(offs.get(other, ()), start - EDGE_S, until)
            surrounded = bool(across) and across[0] < start and across[-1] > end
            reason = ""
            if len(inside) > 1 or (surrounded and not inside):
                count = f"{len(inside)} contacts" if inside else "no contact"
                reason = f"{count} of the other foot within the cycle: a contact was missed or is false"
            cycles.append(Cycle(side, start, end, (by, next_by), off, max(lift, start), landed, off_by, False, reason))
    return cycles


def plate_loadings(trial: Trial, rise_n: float = RISE_N) -> Loadings:
    """When the plates of a trial were loaded: by the foot that a force belongs to, or, of no foot, under "".

    A foot's own force is that of a belt, or of the plates that it stepped on; where there is one, others do not count.
    Plates of no foot were loaded by more than `rise_n` [N], and for a time that is whole in the recording.
    """
    if "forces" not in trial.streams:
        return {}
    forces = trial.stream("forces").selected_by(lambda channel: channel.quantity == "vertical_force")
    belts = any(channel.side for channel in forces.channels)
    loadings: dict[str, list[Span]] = {}
    for channel, force in zip(forces.channels, forces.values.T, strict=True):
        known = finite_values(force)
        if not len(known) or (belts and not channel.side):
            continue
        upward = -force if -known.min() > known.max() else force
        rise = BELT_RISE * np.abs(known).max() if belts else rise_n  # a foot's own force may be in N/kg
        spans = loadings.setdefault(channel.side, [])
        for start, end in loaded(upward, forces.rate_hz, rise):
            if belts or (start > 0 and end < len(force)):
                spans.append(Span(float(forces.time[start]), float(forces.time[end - 1])))
    return loadings


def is_kinetic(
    cycle: Cycle, plates: Loadings, steps: Sequence[PlateStep] | None = None, doubted: Sequence[Span] = ()
) -> bool:
    """Whether the foot alone loaded one plate for the whole stance, or has a force of its own.

    Where moments were computed from markers, the stance is a clean step of the foot, whole in the recording. Elsewhere
    one plate is loaded from this contact to this foot off, for no longer than a stance, and no other begins then; or a
    force of its own is there for more than half of the stance, since over ground a foot also steps beside its plates.

    steps: on all plates; None without moments from markers
    doubted: spans of which no kinetics are shown where they fill more than half of the stance
    """
    stance = Span(cycle.start, cycle.foot_off)
    if max([0.0, *(span.shared(stance).seconds for span in doubted)]) > 0.5 * stance.seconds:
        return False
    if steps is not None:
        clean = (step for step in steps if step.clean and step.whole and step.side == cycle.side)
        return any(max(abs(s.start - stance.start), abs(s.end - stance.end)) <= EDGE_S for s in clean)
    begun = [span for span in plates.get("", ()) if abs(span.start - stance.start) <= EDGE_S]
    if len(begun) == 1 and abs(begun[0].end - stance.end) <= EDGE_S:
        return bool(begun[0].seconds <= LONGEST_STANCE * cycle.duration_s)
    off = stance.end if np.isfinite(stance.end) else cycle.start + 0.5 * cycle.duration_s
    carried = [span.shared(Span(cycle.start, off)).seconds for span in plates.get(cycle.side, ())]
    return bool(sum(max(0.0, seconds) for seconds in carried) > 0.5 * (off - cycle.start))


def without_stated(cycles: list[Cycle], entries: Sequence[str], file: str) -> tuple[list[Cycle], list[Finding]]:
    """Same cycles, left out where the study says so, by side and start, and a finding for what it says of no cycle.

    >>> cycles = [Cycle("l", 2.305, 3.4, ("force", "force"))]
    >>> found, unknown = without_stated(cycles, ("left 2.31 stumbled", "right 9.1"), "P01 fast")
    >>> found[0].reason, unknown[0].what
    ('left out by the study: stumbled', "leave_out_cycles contains 'right 9.1', but no cycle begins there")
    """
    new_cycles, findings = list(cycles), []
    for words in entries:
        match = LEFT_OUT_CYCLE.fullmatch(words)
        side, start, reason = (match[1], float(match[2]), match[3]) if match else ("", 0.0, "")
        near = {abs(cycle.start - start): i for i, cycle in enumerate(new_cycles) if cycle.side == side}
        if near and min(near) <= SAME_START_S:
            at = near[min(near)]
            new_cycles[at] = replace(new_cycles[at], reason=f"left out by the study: {reason or 'no reason is given'}")
        else:
            what = f"leave_out_cycles contains {words!r}, but no cycle begins there"
            findings.append(Finding("warning", "cycle not found", file, what, "nothing; correct it with cycles.csv"))
    return new_cycles, findings


@dataclass(frozen=True, eq=False)
class HeelPaths:
    """Where the heels of a trial were, and which way the person walked."""

    time: Values  # (frame,) [s], of the markers
    heels: Mapping[str, Values]  # each (frame, 3) [m], by side
    way: Direction


def heel_paths(trial: Trial, direction: str = "") -> HeelPaths | None:
    """Paths of the heels, in a direction `+x` to `-z` or as inferred; None where markers do not show them."""
    known = trial_markers(trial, direction)
    if known is None:
        return None
    heels, _, way = known
    markers = trial.stream("markers")
    return HeelPaths(markers.time, {side: marker_position(markers, name) for side, name in heels.items()}, way)


def find_places(cycle: Cycle, feet: HeelPaths | None, belt_m_per_s: float = 0.0) -> Places:
    """Where the feet were in a cycle, a belt's way at its speed [m/s] added; without paths the step's time alone."""
    step_s = cycle.end - cycle.opposite_contact
    if feet is None:
        return Places(step_s, (belt_m_per_s or NAN) * cycle.duration_s)
    way, other = feet.way, other_side(cycle.side)
    first, beside, last = (
        interpolate(feet.time, feet.heels[side], np.array([at]))[0]
        for side, at in ((cycle.side, cycle.start), (other, cycle.opposite_contact), (cycle.side, cycle.end))
    )
    stride = _level(last - first, way.up)
    length = float(np.linalg.norm(stride))
    over_ground = way.headings is not None and length >= SHORTEST_STRIDE_M
    forward = stride / length if over_ground else _level(way.forward, way.up)
    across = np.cross(forward, way.up) * (1.0 if cycle.side == "r" else -1.0)
    return Places(
        step_s,
        float(np.dot(stride, forward)) + belt_m_per_s * cycle.duration_s,
        float(np.dot(last - beside, forward)) + belt_m_per_s * step_s,
        float(np.dot(first - beside, across)),
    )


def with_gaps(cycles: list[Cycle], legs: Recording | None) -> list[Cycle]:
    """Same cycles, left out where an angle of the own leg is missing after bridging, or nothing was recorded."""
    if legs is None:
        return cycles
    angles = {side: legs.selected([channel.name for channel in legs.channels if channel.side == side]) for side in "lr"}
    new_cycles = list(cycles)
    for place, cycle in enumerate(cycles):
        if not cycle.reason and angles[cycle.side].names:
            (reason,) = gap_reasons(np.array([cycle.start]), np.array([cycle.end]), angles[cycle.side])
            new_cycles[place] = replace(cycle, reason=reason)
    return new_cycles


def _first(times: tuple[tuple[float, str], ...], start: float, end: float) -> tuple[float, str]:
    return next(((at, by) for at, by in times if start <= at <= end), (NAN, ""))


def _level(vector: Values, up: Values) -> Values:
    return vector - np.dot(vector, up) * up


def cycle_channels(
    trial: Trial, filters: Filters, from_markers: Sequence[str] = ()
) -> tuple[Recording | None, tuple[Recording, ...], tuple[Finding, ...]]:
    """Angles, moments, powers, belt forces and EMG envelopes of a trial, those of the vocabulary.

    Filtered is what was measured, and angles computed here. Moments and powers computed here are of filtered markers
    and forces; angles, moments, powers and weighed forces of the file are as the file has them.

    returns legs: angles of the legs, gaps bridged where they may be, not filtered
    returns states: what cycles are cut of, each at its own rate
    """
    legs, states, findings, words = None, [], [], []
    for key, quantities in (
        ("kinematics", ("angle", "translation")),
        ("moments", ("moment", "power")),
        ("forces", ("force", "vertical_force")),
        ("emg", ("emg",)),
    ):
        recording = _list_known(trial, key, quantities)
        if recording is None:
            continue
        try:
            state, how = _filter(key, recording, filters, key in from_markers)
        except GaitdiscError as error:
            findings.append(Finding("warning", "left out", trial.name, f"{key}: {error}", f"curves of the {key}"))
            continue
        if key == "kinematics":
            names = [channel.name for channel in recording.channels if channel.name.startswith(LEGS)]
            legs = fill_gaps(without_spikes(recording.selected(names)), None, filters.gap_s) if names else None
        if state is not None:
            states.append(state)
            words.append(how)
    weighed = scale_forces(trial)
    if weighed is not None and not any(set(weighed.names) & set(state.names) for state in states):
        states.append(weighed)
        words.append("forces in % of body weight as in the file")
    notes = [Finding("note", "filter", trial.name, "; ".join(words), "")] if words else []
    return legs, tuple(states), (*findings, *notes)


def _list_known(trial: Trial, key: str, quantities: tuple[str, ...]) -> Recording | None:
    """Channels of the vocabulary that have a value; forces only where they belong to a foot."""
    if key not in trial.streams:
        return None
    words = {channel.name for channel in vocabulary().channels}
    recording = trial.stream(key)
    if key == "kinematics":
        recording = with_pelvis_and_foot(recording)
    known = recording.selected_by(
        lambda c: c.name in words and c.quantity in quantities and (key != "forces" or bool(c.side))
    )
    names = [name for name in known.names if np.isfinite(known[name]).any()]
    return known.selected(names) if names else None


def _filter(key: str, recording: Recording, filters: Filters, computed: bool) -> tuple[Recording | None, str]:
    """Recording as it is shown, and which filter it had; what a file computed has none here."""
    low = f"low-pass {filters.kinematics_hz:g} Hz"
    if key == "emg":
        raw, slow = is_raw(recording), f"low-pass {filters.emg_lowpass_hz:g} Hz"
        how = f"EMG high-pass {filters.emg_highpass_hz:g} Hz, rectified, {slow}" if raw else f"EMG {slow}"
        live = live_channels(recording) if raw else recording.names
        return (make_envelope(recording.selected(live), filters, raw), how) if live else (None, "")
    if key == "forces":
        return low_pass(recording, FORCE_HZ, filters.order, filters.gap_s), f"forces low-pass {FORCE_HZ:g} Hz"
    if key == "moments" and computed:
        return recording, f"moments and powers from markers ({low}) and forces ({FORCE_HZ:g} Hz)"
    if key == "moments":
        return fill_gaps(recording, None, filters.gap_s), "moments and powers as in the file"
    angles = fill_gaps(without_spikes(plateau_marked(recording)), None, filters.gap_s)
    if not computed:
        return angles, "angles as in the file"
    return low_pass(angles, filters.kinematics_hz, filters.order, filters.gap_s), f"angles from markers, {low}"


def scale_forces(trial: Trial) -> Recording | None:
    """Forces of the ground on each foot [% of body weight], zero off the plate; None where the file has none.

    Plug-in Gait's `NormalisedGRF` is fore-aft and vertical in percent of body weight, empty off the plate. Forwards is
    positive here: the first half of a step brakes, and a file in which it does not is turned.
    """
    if "moments" not in trial.streams:
        return None
    moments = trial.stream("moments")
    forces: dict[Channel, Values] = {}
    for side, letter in (("l", "L"), ("r", "R")):
        labels = [f"{letter}NormalisedGRF.{axis}" for axis in "xz"]
        if any(label not in moments.names or moments.channels[moments.index(label)].unit != "%" for label in labels):
            continue
        along, upwards = (np.nan_to_num(moments[label]) for label in labels)
        loaded = upwards > LOADED_PERCENT
        if loaded.any():
            braking = sum(float(along[a : (a + b) // 2].sum()) for a, b in runs(loaded))
            forces[Channel(f"ground_force_{side}_vx", "force", "%", side)] = -along if braking > 0 else along
            forces[Channel(f"ground_force_{side}_vy", "vertical_force", "%", side)] = upwards
    if not forces:
        return None
    return Recording(moments.time, np.column_stack([*forces.values()]), tuple(forces), trial.subject, trial.condition)


def with_pelvis_and_foot(angles: Recording) -> Recording:
    """Same angles, and those of the pelvis and of foot progression that stand under Plug-in Gait's labels alone."""
    taken: dict[int, tuple[Channel, float]] = {}
    for name, (label, sign) in PLUG_IN_GAIT.items():
        channel = vocabulary().named(name)
        if channel is None or name in angles.names or label not in angles.names:
            continue
        column = angles.names.index(label)
        if (angles.channels[column].quantity, angles.channels[column].unit) == (channel.quantity, channel.unit):
            taken[column] = (channel, sign)
    if not taken:
        return angles
    columns, signs = list(taken), np.array([sign for _, sign in taken.values()])
    channels, marks = tuple(channel for channel, _ in taken.values()), angles.suspect[:, columns]
    new = replace(angles, values=angles.values[:, columns] * signs, channels=channels, suspect=marks)
    return join_recordings(angles, _from_own_heading(new))


def _from_own_heading(angles: Recording) -> Recording:
    """Same angles; of a pelvis that turns in the laboratory tilt and list about its own heading, its mean of a second.

    About an axis of the laboratory, tilt is obliquity once a person has turned by 90 deg. Angles about the line of
    walking are missing then.
    """
    if not {"pelvis_tilt", "pelvis_list", "pelvis_rotation"} <= set(angles.names):
        return angles
    turned = unwrap(angles)["pelvis_rotation"]
    seen, half = np.flatnonzero(np.isfinite(turned)), max(round(PATH_S * angles.rate_hz / 2), 1)
    if not len(seen) or seen[-1] - seen[0] < 2 * half:
        return angles
    between = np.interp(np.arange(seen[0], seen[-1] + 1), seen, turned[seen])
    means = np.convolve(between, np.full(2 * half + 1, 1 / (2 * half + 1)), "valid")  # of whole seconds, held beyond
    heading = np.pad(means, (seen[0] + half, len(turned) - 1 - seen[-1] + half), mode="edge")
    if np.ptp(heading) < STRAIGHT_DEG:
        return angles
    from scipy.spatial.transform import Rotation

    turns = [[0 * heading, 0 * heading, heading], [angles["pelvis_tilt"], angles["pelvis_list"], turned]]
    level, lab = (Rotation.from_euler("ZXY", np.transpose(each), degrees=True).as_matrix() for each in turns)
    values = np.full(angles.values.shape, np.nan)
    values[:, [angles.index("pelvis_tilt"), angles.index("pelvis_list")]] = clinical_angles(level, lab)[:, :2]
    return angles.with_values(values)
