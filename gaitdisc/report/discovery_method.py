"""How the numbers of a discovery were made, as its page says it."""

from __future__ import annotations

from dataclasses import dataclass

from gaitdisc.results.discovery import DEVICE, ENGINE, TRACKED, Discovery

BOUNDS = (
    "Numbers to which the file gives two bounds were fitted within these, in the simulation as read and in every "
    "explanation alike (half the width is two standard deviations); a wrong parameter is one that has to leave them."
)
WEIGHED = (
    "Every explanation was weighed at every place where it may enter: the effects of the catalogue, and beside them "
    "wrong parameters, late or scaled inputs, and errors of the sensors. The best were fitted in full, with the "
    "constants inside them (a threshold, a delay, a frequency)."
)
EVIDENCE = (
    "Evidence is twice the log likelihood, under noise whose memory was learned from what is left, less the logarithm "
    "of the number of samples for each number fitted."
)
UNNAMED = "What no name explains, and a fitted shape does, has no name."
SHORT_RUNS = (
    "Trials were cut into short runs. Each run's start was found, so that only the dynamics, the inputs and the "
    "sensors could be wrong; whole trajectories were compared with the measurement, never derivatives of it.",
    BOUNDS,
    WEIGHED,
    EVIDENCE,
    "What was found had to make the squared error fall on the held-out data, of which nothing was fitted but the start "
    "of each run, beside another effect too: what it changes there has to go along with what was left (one-sided test, "
    "each sample by its size, with the autocorrelation of what is left: Newey and West 1987). The intervals follow "
    "from the curvature of the likelihood under that noise.",
    "The noise floor is the noise of the sensors, estimated from the record without any model: what a cubic over seven "
    "samples leaves. Where up to four explanations leave no more, they are the answer. Where all leave more, sets of "
    "them were weighed by the share of the gap that they close on runs left out of the fit, less a price for each: 3 % "
    "of the gap for a plain term, up to 10 % for what can imitate anything (a delay, a product, a periodic force). "
    "What closes less than 5 % is listed as small.",
    UNNAMED,
)
BY_ENGINE = (
    "The engine computed the accelerations along the smoothed record, and how they change with each coordinate, speed, "
    "control and parameter; a force on a coordinate enters exactly. The short runs below are runs of that expansion; "
    "along muscles with fibres its error is counted as noise, 2 % of a channel's spread.",
    *SHORT_RUNS,
    "Where all that was found has a form in the model's own file, and no muscle has fibres, its numbers and their "
    "intervals were fitted once more by the engine's own runs.",
    "What has a form in the model's own file was inserted there, loaded again, and its accelerations compared with the "
    "expression as a force by hand. The engine then ran the model without and with it over held-out runs, each from "
    "the start that suits it best (findings, below): what these runs do not bear out is taken back.",
)
ALONG_A_WALK = (
    "The measured motion was prescribed. Inverse dynamics gave the moments that it demands beside the recorded forces "
    "of the ground; moment arms gave what the forces of muscles and actuators in the file make of them. Nothing was "
    "run forward in the search.",
    "What is left was searched joint by joint for every shape of the catalogue, and for groups of muscles that give "
    "more or less than the file says, or later. Noise of the angles was drawn, low-passed as the record and sent "
    "through the same inverse dynamics; the noise of a joint is that, or what the best explanation leaves.",
    "Evidence is the fall of twice the log likelihood under that noise, less the logarithm of the number of samples "
    "for each number fitted, and less the price of having chosen among all explanations at all joints.",
    "Each block of the time was predicted with numbers of the rest of it, nothing within half a period of the "
    "low-pass learned from; after is what that leaves. Named is what has evidence of 10 or more and closes 30 % of the "
    "squared moment that is left; of two that predict alike the plainer one. That is a proof on one walk, often of "
    "one stride: a second walk is another matter.",
    "The noise floor of a moment is that of the angles through inverse dynamics, and 1 % of the moment's spread.",
    "What was found was inserted into the model's file, and OpenSim computed the moments once more, and short forward "
    "runs from the measured motion (findings, above).",
)
OF_A_DEVICE = (
    "The Nominal walk calibrated a moment model of this person: each muscle's envelope after a delay and a first-order "
    "lag, less what the joint's speed leaves of it, times a gain that varies with the angle, of the sign that anatomy "
    "gives it; a stiffness about the usual stride in five parts of it; and what repeats itself over the stride.",
    "Each possible change was fitted together with the gains to the strides of both walks, the last quarter of the "
    "device walk left out; the best counts where it takes a tenth of the squared error there. The number that is said "
    "is that of both walks.",
    "Beside these gains the device walk was searched in trials of three strides, the measured motion prescribed.",
    WEIGHED,
    EVIDENCE,
    "What was found had to make the squared error of the moment fall on the last quarter of the walk: p < .05 in a "
    "one-sided test, each sample by its size. The interval joins the noise, strides of both walks drawn anew, and "
    "what another speed at which muscles lose their force, another lag, gains that are less alike and a degree of the "
    "usual stride make of the number.",
    "Where the ankle lacks nothing, a mass at the foot is weighed at the knee, and named where the hip bears it out.",
    UNNAMED,
)


@dataclass(frozen=True)
class Method:
    """How an answer was made."""

    sentences: tuple[str, ...]
    held_out: str  # what the figure's caption says of it
    added_to: str  # what holds the model with what was found


RUNS_HELD_OUT = "held out: neither searched nor fitted, only the start of each run was found"
METHODS = {
    ENGINE: Method(BY_ENGINE, RUNS_HELD_OUT, "In augmented.toml, and in the model's own file as far as it has a form:"),
    TRACKED: Method(
        ALONG_A_WALK,
        "with what was found as each block of the time is predicted from the rest of it",
        "In the model's own file as far as it has a form there, and in the mapping beside it:",
    ),
    DEVICE: Method(
        OF_A_DEVICE,
        "held out: neither searched nor fitted",
        "In augmented.toml, the moment model of this person:",
    ),
}
OF_A_SIMULATION = Method(SHORT_RUNS, RUNS_HELD_OUT, "In augmented.toml, which runs as the simulation does:")


def method_of(discovery: Discovery) -> Method:
    """How an answer was made, by what its provenance says."""
    made = discovery.provenance
    return METHODS.get(made.section, OF_A_SIMULATION) if made else OF_A_SIMULATION
