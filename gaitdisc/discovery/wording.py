"""The answer in one sentence that a clinician or an engineer understands."""

import math
import re
from dataclasses import replace

from gaitdisc.discovery.candidate import SIGNAL_ERRORS
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.effect_words import (
    LOSSES,
    MINUS,
    SPRINGS,
    amount,
    at_place,
    brief_text,
    display_channel,
    display_unit,
    estimate_text,
    named_at,
    outside_text,
    spoken,
    would_distinguish,
)
from gaitdisc.discovery.result import ODD_TRIAL, Discovery, Estimate, FoundEffect, GapSize, Whereabouts
from gaitdisc.discovery.scored_model import Part
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.units import find_dimension
from gaitdisc.words import with_unit

MECHANICAL = {find_dimension(unit) for unit in ("N", "N m", "N/kg", "N m/kg", "rad/s^2", "1", "unknown")}
FEW = 12  # independent samples of held-out data
SMALL = 0.05  # of the squared error
UNIT_SLACK = 0.05
OTHER_UNITS = (  # gains of a sensor that another convention makes
    (math.pi / 180, ", as if radians were read as degrees"),
    (180 / math.pi, ", as if degrees were read as radians"),
    (-1.0, ", as if its sign were reversed"),
    (1e3, ", as if its unit were wrong by a factor of 1000, such as mm read as m"),
    (1e-3, ", as if its unit were wrong by a factor of 1000, such as m read as mm"),
)
SATURATED = {"limit": "beyond {} in both directions", "upper_limit": "above {}", "lower_limit": "below {}"}
DIRECTIONS = re.compile(
    r"\b(dorsiflexion|plantarflexion|flexion|extension|abduction|adduction|inversion|eversion|pronation|supination|"
    r"internal rotation|external rotation|tilt|obliquity)\b"
)


def write_sentence(discovery: Discovery, base: Simulation, parts: tuple[Part, ...]) -> Discovery:
    """Return the discovery with its sentence; parts: the explanations behind its effects, in their order."""
    odd = (finding for finding in discovery.findings if finding.kind == ODD_TRIAL)
    sentences = [
        _say(discovery, base, parts),
        _say_given(discovery),
        _say_tied(discovery),
        _say_gap(discovery),
        _say_moved(discovery),
        *(f"{finding.what[:1].upper()}{finding.what[1:]}. This trial was left out." for finding in odd),
    ]
    return replace(discovery, sentence=" ".join(sentence for sentence in sentences if sentence))


def _say(discovery: Discovery, base: Simulation, parts: tuple[Part, ...]) -> str:
    if discovery.verdict in ("no_gap", "unexplained"):
        return _nothing(discovery)
    effects = discovery.effects
    if discovery.verdict == "process_noise":
        where = at_place(effects[0].kind, effects[0].place)
        push = estimate_text(effects[0].estimates["strength"])
        other = "one trial cannot show whether a" if discovery.held_out.of.endswith("quarter") else "no"
        return f"Process noise of {push} (standard deviation) acts {where}; {other} deterministic effect is missing."
    if discovery.verdict == "wrong_initial_condition":
        starts = " and ".join(f"{effect.place} at {estimate_text(effect.estimates['initial'])}" for effect in effects)
        return f"Only the initial condition is wrong: trials begin with {starts}; the dynamics agree within the noise."
    if discovery.verdict == "unnamed":
        return f"{_say_unnamed(effects[0], base, discovery.where)}."
    texts = [_one(effect, part, base, discovery.where) for effect, part in zip(effects, parts, strict=True)]
    missing = [text for text, part in zip(texts, parts, strict=True) if part.candidate.verdict == "missing_physics"]
    errors = [text for text, part in zip(texts, parts, strict=True) if part.candidate.verdict != "missing_physics"]
    lacks = [f"The simulation lacks {'; and '.join(missing)}"] if missing else []
    sentence = "; besides, ".join([*lacks, *errors])
    return f"{sentence[:1].upper()}{sentence[1:]}."


def _say_given(discovery: Discovery) -> str:
    """Say that nothing was searched, and whether held-out data bear out what was given."""
    if not discovery.given:
        return ""
    bear = "support it" if discovery.given == "proven" else "do not support it"
    sentence = f"The effect was given, not searched for: the held-out data {bear} ({_chance(discovery.held_out)})."
    idle = [named_at(effect) for effect in discovery.effects if effect.small]
    return f"{sentence} The other effects suffice without {' or '.join(idle)}." if idle else sentence


def _nothing(discovery: Discovery) -> str:
    """Say that nothing is named, and whether the data that were learned from speak for something all the same."""
    stated = next((finding.what for finding in discovery.findings if finding.kind.endswith("stated errors")), "")
    if stated and discovery.verdict == "no_gap":
        return f"No effect is named: {stated}."
    first = discovery.rivals[0] if discovery.rivals else None
    if first is None or not first.bic >= CRITERIA.support:
        if discovery.verdict == "no_gap" and may_be_left(discovery.held_out.before, discovery.held_out):
            return "Simulation and data agree within the noise: these data show no missing effect."
        if discovery.verdict == "no_gap":
            return (
                "These data show no missing effect: the residual exceeds the sensors' white noise, but does not grow "
                "along a run."
            )
        return (
            "No effect is named: simulation and data differ by more than the sensors' noise, and no tested explanation "
            f"meets the criteria for a name.{_removes_most(discovery)}"
        )
    tested = f" ({_chance(discovery.held_out)})" if discovery.held_out.pieces else ""
    for_what = named_at(first)
    if discovery.held_out.p < discovery.held_out.alpha:
        return (
            f"No effect is named: the best explanation, {for_what}, removes less than half of the held-out error. "
            "Several effects may act at the same time; trials in which fewer effects act can distinguish them."
        )
    return (
        f"No effect is named: the training data indicate {for_what}, but the held-out data do not support it{tested}. "
        "More trials of varied movement can decide."
    )


def _removes_most(discovery: Discovery) -> str:
    """Say which of the listed explanations removes most of the held-out error beyond chance."""
    for explanation in discovery.explanations:
        size = explanation.held_out
        if size and size.p < size.alpha and size.unexplained < 1:
            effects = " and ".join(named_at(effect) for effect in explanation.effects)
            closed = f"{100 * (1 - size.unexplained):.0f} % of the squared held-out error above the noise"
            return f" The listed explanation that removes most is {effects}: {closed}. New trials can decide."
    return ""


def may_be_left(error: float, size: GapSize) -> bool:
    """Whether an error is no more than the sensors' noise and a hundredth of the measurement's spread explain."""
    return error < CRITERIA.agrees * math.hypot(size.noise_floor, CRITERIA.model_error)


def _one(effect: FoundEffect, part: Part, base: Simulation, where: tuple[Whereabouts, ...]) -> str:
    kind = part.candidate.verdict
    if kind == "missing_physics":
        return _missing(effect, part, base, where)
    if kind == "wrong_parameter":
        estimate = effect.estimates["value"]
        unit, factor = display_unit(estimate.unit)
        file_value = with_unit(f"{factor * base.values()[effect.place]:.6g}", unit)
        outside = outside_text(effect, estimate)
        text = f"the parameter {effect.place} is {estimate_text(estimate)}, but {file_value} in the file"
        return f"{text}, {outside}" if outside else text
    estimate = next(iter(effect.estimates.values()))
    subject = f"the {'driving signal' if kind == 'input_error' else 'measured'} {effect.place}"
    if effect.name.endswith("_saturation"):
        subject = f"the force of {effect.place}" if effect.name == "force_saturation" else subject
        limits = (SATURATED[name].format(estimate_text(limit)) for name, limit in effect.estimates.items())
        return f"{subject} saturates {' and '.join(limits)}"
    return f"{subject} {_signal(effect.name, estimate)}"


def _signal(name: str, estimate: Estimate) -> str:
    """Say what is wrong with a signal."""
    error, low = SIGNAL_ERRORS[name], estimate.value < 0
    if error.slot == "gain":
        units = OTHER_UNITS if name == "sensor_gain" else ()
        like = next((words for factor, words in units if abs(estimate.value / factor - 1) < UNIT_SLACK), "")
        return error.above.format(estimate_text(estimate)) + like
    size = Estimate(-estimate.value, -estimate.high, -estimate.low, estimate.unit) if low else estimate
    return ((error.below if low else "") or error.above).format(estimate_text(size))


def _missing(effect: FoundEffect, part: Part, base: Simulation, where: tuple[Whereabouts, ...]) -> str:
    noun, _, how = (part.candidate.means or spoken(effect.name)).partition(", ")
    if effect.name.endswith("_coupling"):
        noun = f"{noun} ({part.candidate.pieces[0]})"
    elif effect.name in SPRINGS | LOSSES and not _is_force(effect, base):
        opposes = effect.term.startswith("-") == (next(iter(effect.estimates.values())).value > 0)
        form = re.sub(r"^\((\w+)\)$", r"\1", re.sub(r"\b_", "", part.candidate.pieces[0]))
        noun = f"a term proportional to {MINUS * opposes}{form}"
    names, rest = part.candidate.names or {}, dict(effect.estimates)
    for slot in part.candidate.constants or {}:
        if f"{{{slot}}}" in how:
            how = how.replace(f"{{{slot}}}", _constant(rest.pop(names.get(slot, slot)), part, base))
    many = len(rest) > 1
    numbers = [f"{name.replace('_', ' ')} " * many + estimate_text(estimate) for name, estimate in rest.items()]
    if len(numbers) > 4:
        numbers = [f"{len(numbers)} numbers, largest {max(rest.items(), key=lambda pair: abs(pair[1].value))[0]}"]
    role = part.candidate.role
    of = f" of {role}" if " " in role and not how and effect.kind == "port" else ""  # a difference of two states
    texts = [f"{noun}{of} {at_place(effect.kind, effect.place)}: {', '.join(numbers)}", how, _stride(effect, where)]
    return ", ".join(text for text in texts if text)


def _is_force(effect: FoundEffect, base: Simulation) -> bool:
    """Whether an effect adds to a force, a moment or their acceleration, as far as the units of its place say."""
    units = {port.name: port.unit for port in base.ports} if effect.kind == "port" else {}
    units |= {state.name: "1" if state.unit == "1" else f"{state.unit}/s" for state in base.states}
    return find_dimension(units.get(effect.place, "unknown")) in MECHANICAL


def _constant(estimate: Estimate, part: Part, base: Simulation) -> str:
    meaning = {state.name: state.meaning for state in base.states}
    role = part.candidate.role
    if estimate.unit in ("s", "1", "rad/s"):
        return brief_text(estimate)
    direction = DIRECTIONS.search(meaning.get(role, ""))
    seen = direction[0] if direction else role.replace(" - ", " minus ")
    return f"{brief_text(estimate)} of {seen}"


def _stride(effect: FoundEffect, where: tuple[Whereabouts, ...]) -> str:
    phase = next((place.phase for place in where if place.place == effect.place and place.phase), ())
    return f"seen between {100 * phase[0]:.0f} and {100 * phase[1]:.0f} % of the stride" if phase else ""


def _say_unnamed(effect: FoundEffect, base: Simulation, where: tuple[Whereabouts, ...]) -> str:
    seen = [signal for signal in base.signals if re.search(rf"\b{re.escape(signal)}\b", effect.term)]
    over = f", a function of {' and '.join(seen)}," if seen else ""
    stride = _stride(effect, where)
    acts = f" ({stride})" if stride else ""
    missing = f"An effect is missing {at_place(effect.kind, effect.place)}"
    if effect.reads_as_effect:
        shape = f"{effect.reads_as} ({spoken(effect.reads_as_effect)} in the catalogue)"
        return f"{missing}{acts}; the fitted shape is {shape}"
    shape = f"is approximately {effect.reads_as}" if effect.reads_as else "replaces it"
    return f"{missing}{acts}. The effect is not in the catalogue; a fitted shape{over} {shape}"


def _say_tied(discovery: Discovery) -> str:
    tied = [rival for rival in discovery.rivals if rival.tied]
    if not tied or not discovery.effects:
        return ""
    names = " or ".join(named_at(rival) for rival in tied)
    recording = would_distinguish(discovery.effects[0].name, tied[0].name)
    return f"These data cannot distinguish it from {names}. To distinguish them, record {recording}."


def _say_gap(discovery: Discovery) -> str:
    """Say how large the held-out error is, and what becomes of it: as the numbers have it."""
    sizes = discovery.held_out.channels
    if not sizes:
        return ""
    channel = discovery.held_out.ranked[0]
    unit, factor = display_channel(discovery, channel)
    floor = factor * sizes[channel][2]
    of = f" of {channel}" if len(sizes) > 1 else ""
    noise = f"noise floor {amount(floor, floor / 10)}"
    if discovery.verdict in ("no_gap", "unexplained", "process_noise", "wrong_initial_condition"):
        before = with_unit(amount(factor * sizes[channel][0], floor / 10), unit)
        return f"Held-out error{of}: {before} ({noise})."
    worse = [name for name in sizes if name != channel and _goes(discovery, name).startswith("rises")]
    rises = "".join(f"; that of {name} {_goes(discovery, name)}" for name in worse)
    size = discovery.held_out
    few = 0 < size.pieces < FEW and size.after <= size.before
    tested = f", {_chance(size)}" if few else ""
    sentence = f"With it, the held-out error{of} {_goes(discovery, channel)} ({noise}{tested}){rises}."
    unexplained = size.unexplained
    if unexplained < SMALL or size.after > size.before or may_be_left(size.after, size):
        return sentence
    return f"{sentence} {100 * unexplained:.0f} % of the squared error above the noise remains unexplained."


def _say_moved(discovery: Discovery) -> str:
    """Name the numbers that clearly moved within their bounds."""
    changes = []
    for correction in discovery.corrections:
        if not correction.found.low <= correction.given <= correction.found.high:
            unit, factor = display_unit(correction.found.unit)
            initial = with_unit(f"{factor * correction.given:.6g}", unit)
            changes.append(f"{correction.parameter} from {initial} to {brief_text(correction.found)}")
    return f"Parameters that changed within their bounds: {', '.join(changes)}." if changes else ""


def _goes(discovery: Discovery, channel: str) -> str:
    """Say whether an error falls, rises or does not change, to the digits that the noise leaves worth writing."""
    size, (unit, factor) = discovery.held_out.channels[channel], display_channel(discovery, channel)
    step = factor * size[2] / 10
    before, after = (amount(factor * error, step) for error in size[:2])
    if before == after:
        return f"does not change: {with_unit(after, unit)}"
    return f"{'falls' if size[1] < size[0] else 'rises'} from {before} to {with_unit(after, unit)}"


def _chance(size: GapSize) -> str:
    """Say the p of held-out data, and of how many samples."""
    p = f"{size.p:.2g}" if math.isfinite(size.p) else "not computed"
    return f"p = {p} over {size.pieces} independent samples"
