"""Pictures of recordings and results: each function takes `ax=None` and returns matplotlib's Axes.

Without `ax` a new figure is made, which a notebook shows; the caller's own style holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gaitdisc.channel import find_side, hint_nearest
from gaitdisc.errors import ChannelError, ShapeError
from gaitdisc.library.walks import make_recording
from gaitdisc.recording import PERCENT, Recording, Strides
from gaitdisc.recording.arrays import finite_rows
from gaitdisc.report.panels import SIDES, axes_or_new
from gaitdisc.words import label, unit_text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from gaitdisc.comparison.mismatch import Mismatch
    from gaitdisc.discovery.result import Discovery
    from gaitdisc.reconstruction.reconstruction import Reconstruction
    from gaitdisc.reconstruction.reconstructor import Reconstructor
    from gaitdisc.response.participant_response import ResponseRun

STRIDE = "stride [%]"
MOST_SINGLE = 25  # cycles that are drawn one by one
__all__ = ["curves", "cycles", "discovery", "latent", "mismatch", "r2", "reconstruction", "recording"]


def recording(
    recording: Recording | pd.DataFrame, channels: Sequence[str] | str | None = None, ax: Axes | None = None
) -> Axes:
    """Draw channels of a recording over time; samples marked as suspect are drawn over in grey.

    Parameters
    ----------
    recording : Recording or DataFrame
        Measured or simulated; a DataFrame has its times in a column `time` [s].
    channels : str or sequence of str, optional
        Names; the first four where none is given.
    ax : matplotlib.axes.Axes, optional
        To draw in.

    Raises
    ------
    ChannelError
        If there is no channel of a name.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walk = gd.example_walks(5.0)["nominal"].stream("kinematics")
    >>> gd.plot.recording(walk, "knee_angle_r").get_xlabel()
    'time [s]'
    """
    from gaitdisc.processing.curves_figure import draw_recording

    recording = make_recording(recording)
    names = [channels] if isinstance(channels, str) else list(channels or recording.names[:4])
    axes = axes_or_new(ax)
    draw_recording(axes, recording, names)
    return axes


def cycles(recording: Recording | pd.DataFrame, strides: Strides, channel: str, ax: Axes | None = None) -> Axes:
    """Draw every cycle of a channel faint, their mean, and from three cycles on the standard deviation.

    Parameters
    ----------
    recording : Recording or DataFrame
        Filtered, on the clock of the strides.
    strides : Strides
        What `gaitdisc.cycles` gave.
    channel : str
        Name of the channel.
    ax : matplotlib.axes.Axes, optional
        To draw in; several trials may be drawn over each other.

    Raises
    ------
    ChannelError
        If there is no channel of that name.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walk = gd.example_walks(10.0)["nominal"]
    >>> gd.plot.cycles(walk.stream("kinematics"), gd.cycles(walk), "knee_angle_r").get_xlabel()
    'stride [%]'
    """
    from matplotlib.collections import LineCollection

    _refuse_other(strides, "Strides", "gaitdisc.cycles")
    signal = make_recording(recording).selected([channel])
    every = finite_rows(strides.normalised(signal)[:, :, 0])
    axes = axes_or_new(ax)
    if len(every):
        colour, mean = SIDES[find_side(channel)].colour, every.mean(axis=0)
        axes.axhline(0.0, color="#cccccc", linewidth=0.6, zorder=0)
        single = [np.column_stack([PERCENT, cycle]) for cycle in every[:MOST_SINGLE]]
        axes.add_collection(LineCollection(single, colors=colour, linewidths=0.4, alpha=0.35, zorder=1))
        if len(every) > 2:
            sd = every.std(axis=0, ddof=1)
            axes.fill_between(PERCENT, mean - sd, mean + sd, color=colour, alpha=0.18, linewidth=0, zorder=1)
        axes.plot(PERCENT, mean, color=colour, linewidth=1.2, zorder=2)
    _stride_axis(axes, channel, signal.channels[0].unit)
    return axes


def curves(run: ResponseRun, channel: str, participant: str | None = None, ax: Axes | None = None) -> Axes:
    """Draw the mean curves of both walks of a participant, with the standard deviation over strides.

    Parameters
    ----------
    run : ResponseRun
        What `fit_response` or `gaitdisc run` gave.
    channel : str
        Name of the channel.
    participant : str, optional
        Whose walks; the first where none is given.
    ax : matplotlib.axes.Axes, optional
        To draw in.

    Raises
    ------
    ChannelError
        If the walks have no channel of that name.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.plot.curves(gd.load("run"), "ankle_angle_r")  # doctest: +SKIP
    """
    from gaitdisc.processing.curves_figure import curve_numbers, draw_walks, walks_key

    _refuse_other(run, "ResponseRun", "gaitdisc.fit_response")
    numbers = curve_numbers(run, participant or next(iter(run.reported), ""))
    numbers = numbers[numbers["channel"] == _check_known(channel, numbers["channel"])]
    axes = axes_or_new(ax)
    draw_walks(axes, numbers, SIDES[find_side(channel)].colour)
    axes.legend(handles=[walks_key(run)[0], walks_key(run)[1 if find_side(channel) == "l" else 2]], frameon=False)
    _stride_axis(axes, channel, str(numbers["unit"].iloc[0]))
    return axes


def r2(run: ResponseRun, ax: Axes | None = None) -> Axes:
    """Draw R2 of Nominal, Augmented and Exo on the held-out device walk, a row for each output.

    Parameters
    ----------
    run : ResponseRun
        What `fit_response` or `gaitdisc run` gave.
    ax : matplotlib.axes.Axes, optional
        To draw in.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.plot.r2(gd.load("run"))  # doctest: +SKIP
    """
    from gaitdisc.response.r2_tables import draw_r2, r2_key, r2_numbers

    _refuse_other(run, "ResponseRun", "gaitdisc.fit_response")
    numbers, axes = r2_numbers(run), axes_or_new(ax)
    draw_r2(axes, numbers)
    axes.set_xlabel("R² on the held-out device walk [1]")
    null = bool(numbers.loc[numbers["kind"] == "null", "r2"].notna().any())
    axes.legend(handles=r2_key(len(run.responses), null), frameon=False, loc=3, bbox_to_anchor=(0, 1), ncols=3)
    return axes


def discovery(found: Discovery, channel: str | None = None, left: bool = False, ax: Axes | None = None) -> Axes:
    """Draw held-out runs: measured, simulated as given, and with what was found.

    Parameters
    ----------
    found : Discovery
        What `discover` gave.
    channel : str, optional
        Observed channel; the one with the largest gap against its noise where none is given.
    left : bool
        Draw what is left, measured minus simulated, with two standard deviations of the noise in grey.
    ax : matplotlib.axes.Axes, optional
        To draw in.

    Raises
    ------
    ChannelError
        If no channel of that name was observed.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.plot.discovery(gd.load("found"), left=True)  # doctest: +SKIP
    """
    from gaitdisc.discovery.figure import discovery_key, display_runs, draw_left, draw_runs, noise_floor, pick_stretch

    _refuse_other(found, "Discovery", "gaitdisc.discover")
    name = _check_known(channel, found.channels) if channel else found.held_out.ranked[0]
    unit, floor = noise_floor(found, name)
    numbers, axes = pick_stretch(display_runs(found), name), axes_or_new(ax)
    if left:
        draw_left(axes, numbers, name, floor)
    else:
        draw_runs(axes, numbers, name)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"{name} [{unit}]")
    axes.set_title(f"{name}: residual" if left else name)
    axes.legend(handles=discovery_key(measured=not left), frameon=False)
    return axes


def mismatch(found: Mismatch, channel: str, gap: bool = False, ax: Axes | None = None) -> Axes:
    """Draw both walks of a comparison over the stride, shaded where they differ by more than chance.

    Parameters
    ----------
    found : Mismatch
        What `compare` gave.
    channel : str
        Name of the channel.
    gap : bool
        Draw the gap with its band in place of both curves.
    ax : matplotlib.axes.Axes, optional
        To draw in.

    Raises
    ------
    ChannelError
        If there is no channel of that name.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.plot.mismatch(gd.load("compare"), "ankle_angle_r", gap=True)  # doctest: +SKIP
    """
    from gaitdisc.comparison.page import draw_both, draw_gap, mismatch_key, mismatch_numbers

    _refuse_other(found, "Mismatch", "gaitdisc.compare")
    numbers = mismatch_numbers(found, [_check_known(channel, found.names)])
    axes, draw = axes_or_new(ax), draw_gap if gap else draw_both
    draw(axes, numbers, found.regions_of(channel), SIDES[find_side(channel)].colour)
    key = mismatch_key(found, "gap" if gap else "curves")
    if not gap:  # one channel has one side
        line = key[1 if find_side(channel) == "l" else 2]
        line.set_label(found.first)
        key = [key[0], line, key[-1]]
    axes.legend(handles=key, frameon=False)
    _stride_axis(axes, channel, str(numbers["unit"].iloc[0]))
    return axes


def reconstruction(done: Reconstruction, state: str, participant: str | None = None, ax: Axes | None = None) -> Axes:
    """Draw a state over the stride: measured with its spread, and what the models estimate from the sensors.

    Parameters
    ----------
    done : Reconstruction
        What `gaitdisc reconstruct` saved.
    state : str
        Name of the channel.
    participant : str, optional
        Whose test windows; the first where none is given.
    ax : matplotlib.axes.Axes, optional
        To draw in.

    Raises
    ------
    ChannelError
        If there is no state of that name.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.plot.reconstruction(gd.load("reconstruct"), "knee_angle_l")  # doctest: +SKIP
    """
    from gaitdisc.reconstruction.page import draw_state, pick_curves, states_key

    _refuse_other(done, "Reconstruction", "`gaitdisc reconstruct`")
    numbers = pick_curves(done, participant or next(iter(done.participants), ""))
    numbers = numbers[numbers["state"] == _check_known(state, [channel.name for channel in done.states])]
    axes = axes_or_new(ax)
    draw_state(axes, numbers)
    axes.legend(handles=states_key(list(dict.fromkeys(numbers["model"]))), frameon=False)
    unit = next(channel.unit for channel in done.states if channel.name == state)
    _stride_axis(axes, state, unit)
    return axes


def latent(model: Reconstructor, x: ArrayLike, percent: ArrayLike, ax: Axes | None = None) -> Axes:
    """Draw the course of SHRED's latent state over the stride: its first three principal components.

    Parameters
    ----------
    model : Reconstructor
        Fitted, of the kind `shred` or `shred-text`.
    x : array_like (time, sensor)
        Readings of one trial at the model's rate.
    percent : array_like (time,) [% stride]
        Percent stride of these times; NaN where there is none.
    ax : matplotlib.axes.Axes, optional
        To draw in.

    Raises
    ------
    TrainingError
        If the model has no latent state.

    References
    ----------
    Ebers 2023, Fig. 5.1.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.plot.latent(gd.load("model"), readings, percent)  # doctest: +SKIP
    """
    from gaitdisc.processing.curves_figure import LATENT, course_numbers, draw_course
    from gaitdisc.reconstruction.window_model import latent_states, leading

    _refuse_other(model, "Reconstructor", "gaitdisc.Reconstructor")
    windows = model.windows(x, percent)
    axes = axes_or_new(ax)
    draw_course(axes, course_numbers(windows.phi, leading(latent_states(model.model.reconstructor, windows))))
    axes.set_title(LATENT)
    axes.legend(frameon=False)
    return axes


def __dir__() -> list[str]:
    """Names of the pictures alone, for whoever looks through them."""
    return __all__


def _refuse_other(result: object, kind: str, made_by: str) -> None:
    if type(result).__name__ != kind:
        raise ShapeError(
            f"this plot must be given a {kind}, as {made_by} returns it",
            f"found {type(result).__name__}",
            "Pass the result itself, or load it from its folder with gaitdisc.load.",
        )


def _stride_axis(axes: Axes, channel: str, unit: str) -> None:
    axes.set_xlim(0, 100)
    axes.set_xlabel(STRIDE)
    axes.set_ylabel(f"[{unit_text(unit)}]")
    axes.set_title(label(channel))


def _check_known(name: str, among: object) -> str:
    names = list(dict.fromkeys(str(entry) for entry in among))  # type: ignore[attr-defined]
    if name not in names:
        raise ChannelError(
            f"channel {name!r} cannot be drawn",
            f"the result has {', '.join(names[:8]) or 'none'}" + hint_nearest(name, names),
            "Name one of these.",
        )
    return name
