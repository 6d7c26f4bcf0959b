"""Initial contact from the vertical ground force, with hysteresis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Recording
from gaitdisc.recording.runs import runs
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.direction import Direction, marker_position

RISE_N = 50.0
RISE_OF_BODY_WEIGHT = 0.1  # of whoever weighs less than 51 kg
LEAST_RISE_N = 20.0  # a plate's own noise and drift stay below it
REST_N = 20.0  # below which a foot that was on the ground has left it
SHORTEST_S = 0.1  # neither stance nor swing is shorter; what is, is chatter


def rise_of(body_weight_n: float | None) -> float:
    """Force above which a foot is on the ground [N]: 50 N, or a tenth of a light body's weight, at least 20 N.

    >>> rise_of(None), rise_of(64 * 9.81), round(rise_of(30 * 9.81), 2), rise_of(15 * 9.81)
    (50.0, 50.0, 29.43, 20.0)
    """
    if body_weight_n is None:
        return RISE_N
    return min(max(RISE_OF_BODY_WEIGHT * body_weight_n, LEAST_RISE_N), RISE_N)


def loaded(force_n: NDArray[np.float64], rate_hz: float, rise_n: float = RISE_N) -> NDArray[np.intp]:
    """First and last sample of each loading of a plate or belt.

    A loading begins above `rise_n` and ends below 20 N. What is loaded for less than 0.1 s is chatter and
    counts as unloaded; what is then unloaded for less than 0.1 s counts as loaded.

    force_n (time,) [N]: positive upwards on the foot; NaN counts as unloaded
    rise_n: force above which a foot is on the ground [N]
    returns (loading, 2) [sample]: first sample above `rise_n`, and the one after the last above 20 N

    >>> f = np.r_[np.zeros(30), 40, 0, np.full(60, 700.0), np.zeros(30)]
    >>> loaded(f, 100.0).tolist()
    [[32, 92]]
    """
    on, high = force_n > min(REST_N, rise_n), force_n > rise_n
    spans = [(start + int(np.argmax(high[start:end])), end) for start, end in runs(on) if high[start:end].any()]
    shortest = SHORTEST_S * rate_hz
    last = len(force_n)
    kept = [(a, b) for a, b in spans if b - a >= shortest or a == 0 or b == last]
    joined: list[tuple[int, int]] = []
    for start, end in kept:
        if joined and start - joined[-1][1] < shortest:
            joined[-1] = (joined[-1][0], end)
        else:
            joined.append((start, end))
    return np.array(joined, dtype=np.intp).reshape(-1, 2)


def force_contacts(
    forces: Recording, sides: Mapping[str, str] | None = None, body_weight_n: float | None = None
) -> dict[str, Contacts]:
    """Contacts of both feet from one vertical force a foot: a split belt, or force assigned to a foot.

    Contact is where the force rises above 50 N, or less under a light body (`rise_of`), to a fraction
    of a sample, after the foot has been off (`loaded`). A loading that the recording begins with gives no contact.

    forces: channels of quantity `vertical_force` [N]
    sides: channel to `r` or `l`; by default the channels' own sides
    returns: for each side with a channel, with foot off
    """
    if sides is None:
        sides = {c.name: c.side for c in forces.channels if c.quantity == "vertical_force" and c.side}
    if not sides:
        raise ChannelError(
            "contacts from force need a vertical force for a foot",
            f"{forces.source.file or 'the recording'} has {', '.join(forces.names) or 'no channel'}",
            "Say which plate or belt is which foot in [strides], or give markers so that it can be found.",
        )
    found = {}
    for side in sorted(set(sides.values())):
        parts = [_contacts(forces, name, body_weight_n) for name, owner in sides.items() if owner == side]
        found[side] = Contacts(
            np.sort(np.concatenate([p[0] for p in parts])),
            side,
            "force",
            np.sort(np.concatenate([p[1] for p in parts])),
            "; ".join(p[2] for p in parts),
        )
    return found


def plate_contacts(
    forces: Recording,
    markers: Recording,
    heels: Mapping[str, str],
    direction: Direction,
    body_weight_n: float | None = None,
) -> dict[str, Contacts]:
    """Contacts from plates that either foot may hit: the foot that lands is the one whose heel is in front.

    forces: channels of quantity `vertical_force` [N], one a plate
    heels: side (`r`, `l`) to the name of its heel marker
    returns: both sides; empty where no plate was hit by that foot
    """
    times: dict[str, list[float]] = {"r": [], "l": []}
    offs: dict[str, list[float]] = {"r": [], "l": []}
    places = {side: marker_position(markers, name) for side, name in heels.items()}
    middle = np.mean(list(places.values()), axis=0)
    along = {side: direction.ahead(place - middle) for side, place in places.items()}
    for channel in forces.channels:
        if channel.quantity != "vertical_force":
            continue
        on, off, _ = _contacts(forces, channel.name, body_weight_n)
        for time in on:
            place = {side: float(np.interp(time, markers.time, heel)) for side, heel in along.items()}
            if not np.isfinite(list(place.values())).all() or len(place) < 2:
                raise StrideError(
                    "identifying the foot on a plate needs both heel markers at contact",
                    f"{forces.source.file}, {channel.name}: contact at {time:.3f} s, heel missing there",
                    "Fill the marker, or say which plate is which foot.",
                )
            side = max(place, key=lambda key: place[key])
            times[side].append(float(time))
            offs[side] += [float(t) for t in off[off > time][:1]]
    note = f"foot identified by the leading heel, {direction.how}"
    return {s: Contacts(np.unique(times[s]), s, "force", np.unique(offs[s]), note) for s in ("r", "l")}


def _contacts(
    forces: Recording, name: str, body_weight_n: float | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
    force, time = forces[name], forces.time
    known = force[np.isfinite(force)]
    downwards = len(known) > 0 and -known.min() > known.max()
    upward = -force if downwards else force
    rise = rise_of(body_weight_n)
    spans = loaded(upward, forces.rate_hz, rise)
    on = np.array([_crossing(time, upward, start, rise) for start, _ in spans if start > 0])
    off = np.array([time[end - 1] for _, end in spans if end < len(time)])
    sign = ", negative when loaded, taken as force on the plate" if downwards else ""
    return on, off, f"{name} above {rise:.0f} N{sign}"


def _crossing(time: NDArray[np.float64], force: NDArray[np.float64], sample: int, rise_n: float) -> float:
    """Time at which the force passes `rise_n` on its way to `sample`, the first above it."""
    before = force[sample - 1] if np.isfinite(force[sample - 1]) else 0.0
    share = (rise_n - before) / (force[sample] - before)
    return float(time[sample - 1] + np.clip(share, 0.0, 1.0) * (time[sample] - time[sample - 1]))
