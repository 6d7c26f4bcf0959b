"""How the numbers of a discovery were made, as its page says it."""

from dataclasses import dataclass

from gaitdisc.discovery.result import DEVICE, ENGINE, TRACKED, Discovery

BOUNDS = (
    "Parameters with two bounds in the file were fitted within these bounds, in the initial model and in every "
    "explanation. Half of this range counts as two standard deviations. A wrong parameter must lie outside its bounds."
)
WEIGHED = (
    "Every explanation was tested at every place where it can act: the effects of the catalogue, wrong parameters, "
    "late or scaled inputs, and sensor errors. The best explanations were fitted in full, including their constants "
    "(a threshold, a delay, a frequency)."
)
EVIDENCE = (
    "Evidence is twice the log likelihood under autocorrelated noise, estimated from the residuals. For each fitted "
    "parameter, the logarithm of the number of samples is subtracted."
)
UNNAMED = "An effect that only a fitted shape explains remains unnamed."
SHORT_RUNS = (
    "Trials were divided into short runs. The initial state of each run was fitted, so that errors can come only "
    "from the dynamics, the inputs and the sensors. Entire trajectories were compared with the measurement, never "
    "their derivatives.",
    BOUNDS,
    WEIGHED,
    EVIDENCE,
    "The identified effect had to reduce the squared error on the held-out data, also in combination with another "
    "effect. Only the initial states were fitted to these data. The change of the prediction by this effect had to "
    "correlate with the residual (one-sided test; samples are weighted by the size of the change; Newey and West "
    "1987 for autocorrelation). The intervals follow from the curvature of the likelihood.",
    "The noise floor is the sensor noise, estimated from the data without a model: the residual of a cubic fitted "
    "to seven samples. If a set of up to four explanations leaves a residual within the floor, that set is the answer. "
    "Otherwise, sets were compared by the share of the gap that they close on held-out runs, minus a penalty for each "
    "explanation. The penalty is 3 % of the gap for a simple one, and up to 10 % for one that can imitate many others "
    "(a delay, a product, a periodic force). Explanations that close less than 5 % of the gap are listed as small.",
    UNNAMED,
)
BY_ENGINE = (
    "The engine ran the initial model along every trial, in runs of two periods, each from its best-fitting initial "
    "state. If these runs leave only white noise at the level of the sensor noise, no effect is missing, and there was "
    "no search.",
    "The engine then computed the accelerations along the smoothed recording, and their derivatives with respect to "
    "each coordinate, speed, control and parameter. A force on a coordinate enters exactly. The short runs below use "
    "this expansion. With muscle fibres, its error counts as noise of 2 % of a channel's standard deviation.",
    *SHORT_RUNS,
    "If no muscle has fibres, the parameters and their intervals were fitted again with the engine's own runs.",
    "Effects that the model's own file can express were inserted into it and compared with the expression; the others "
    "acted as a force at each step. Runs with all effects, and without each effect, decide: an effect that they do "
    "not support is withdrawn. All errors and shares here are those of the engine's runs.",
)
ALONG_A_WALK = (
    "The measured motion was prescribed. Inverse dynamics gave the moments that this motion requires in addition to "
    "the recorded ground forces. Moment arms gave the moments of the muscle and actuator forces in the file. The "
    "search used no forward simulation.",
    "The residual of each joint was searched for every shape of the catalogue, and for groups of muscles whose force "
    "is larger, smaller or later than in the file. Noise of the angles was simulated, low-passed like the recording "
    "and processed by the same inverse dynamics. The noise of a joint is this noise, or the residual of the best "
    "explanation.",
    "Evidence is twice the gain in log likelihood under that noise, minus two penalties: the logarithm of the number "
    "of samples for each fitted parameter, and one for the choice among all explanations at all joints.",
    "Each block of time was predicted with parameters fitted to the other blocks, without samples closer to it than "
    "half a period of the low-pass cut-off. “After” is the residual of this prediction. An effect is named if its "
    "evidence is at least 10 and if it removes at least 30 % of the squared residual. Of two effects with equal "
    "predictions, the simpler one is named. The evidence is from one walk, often one stride; a second walk may differ.",
    "The noise floor of a moment combines the noise of the angles, propagated by inverse dynamics, and 1 % of the "
    "moment's standard deviation.",
    "The effect was inserted into the model's file, and OpenSim computed the moments again (see the findings above).",
)
OF_A_DEVICE = (
    "A moment model of this person was calibrated on the Nominal walk. Each muscle's envelope, after a delay and a "
    "first-order lag, is reduced with the joint's speed and multiplied by a gain. The gain varies with the angle and "
    "has the anatomical sign. The model also contains a stiffness about the mean stride, one for each of five parts of "
    "the stride, and a moment that repeats in every stride.",
    "Each possible change was fitted together with the gains to the strides of both walks, with the last quarter of "
    "the device walk held out. The best change is accepted if it removes a tenth of the squared error in the held-out "
    "quarter. The reported parameter is fitted to both walks.",
    "With these gains the device walk was searched in trials of three strides; the measured motion was prescribed.",
    WEIGHED,
    EVIDENCE,
    "The identified effect had to reduce the squared error of the moment on the last quarter of the walk: p < 0.05 "
    "in a one-sided test, weighted by the size of the change. The interval combines the noise and resampled strides of "
    "both walks. It also contains the effects of another speed at which muscles lose their force, another lag, less "
    "similar gains and a shift of the mean stride by one degree.",
    "If the ankle shows no effect, a mass added to the foot is estimated from the knee moment. The mass is named if "
    "the hip moment supports it.",
    UNNAMED,
)


@dataclass(frozen=True)
class Method:
    """How an answer was made."""

    sentences: tuple[str, ...]
    held_out: str  # what the figure's caption says of it
    added_to: str  # what holds the model with what was found


RUNS_HELD_OUT = "held out: neither searched nor fitted, except the initial state of each run"
METHODS = {
    ENGINE: Method(BY_ENGINE, RUNS_HELD_OUT, "Added to augmented.toml and, if possible, to the model's own file:"),
    TRACKED: Method(
        ALONG_A_WALK,
        "each block of time predicted from the other blocks",
        "Added to the model's own file, if possible, and to the mapping next to that file:",
    ),
    DEVICE: Method(
        OF_A_DEVICE, "held out: neither searched nor fitted", "Added to augmented.toml, this person's moment model:"
    ),
}
OF_A_SIMULATION = Method(SHORT_RUNS, RUNS_HELD_OUT, "Added to augmented.toml, which runs like your simulation:")


def methods_used(discovery: Discovery) -> Method:
    """How an answer was made, by what its provenance says."""
    made = discovery.provenance
    return METHODS.get(made.section, OF_A_SIMULATION) if made else OF_A_SIMULATION
