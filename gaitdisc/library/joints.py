"""Joint angles and moments from markers and ground forces."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinematics.motion import move_body
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import KineticsSettings
from gaitdisc.kinetics.trial_kinetics import trial_kinetics
from gaitdisc.library.walks import Walk, make_trial
from gaitdisc.processing.markers_to_moments import find_foot_paths
from gaitdisc.processing.side_checks import check_weight, standing_weight_n
from gaitdisc.recording import Recording, Trial
from gaitdisc.recording.trial import BodyMeasures


def angles(
    walk: Walk,
    static: Trial | Path | str,
    marker_set: Path | str | None = None,
    joints: str | None = None,
    forward: Sequence[float] | None = None,
) -> Recording:
    """Compute the joint angles of a walk from its markers.

    Parameters
    ----------
    walk : Trial, path, DataFrame, Recording or sequence of paths
        A walk with markers.
    static : Trial or path
        Static trial of the same person with the same markers; joint widths are read from its C3D file.
    marker_set : str or path, optional
        `plug_in_gait`, `oxford_foot`, `helen_hayes`, `rajagopal`, `gait2354`, or a `.toml` file; by default found from
        the labels.
    joints : str, optional
        `free` (each segment fitted separately), `held` (joined at joint centres), `planar`; default: that of the marker
        set.
    forward : sequence of 3 floats, optional
        Direction of walking in the laboratory's axes; by default computed from the pelvis.

    Returns
    -------
    Recording
        `pelvis_tilt`, `hip_flexion_r`, `knee_angle_r`, ... [deg], `pelvis_tx`, ... [m], with the package's signs.

    Raises
    ------
    ChannelError
        If a marker or a joint width is missing, or the labels match no known marker set.
    ShapeError
        If the laboratory's frame is mirrored or tilted, or left and right are exchanged.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.angles("walk.c3d", "static.c3d")["knee_angle_r"]  # doctest: +SKIP
    """
    trial = make_trial(walk)
    standing, measures = _standing(static)
    motion = move_body(trial.stream("markers"), standing.stream("markers"), marker_set, measures, forward, joints)
    return replace(motion.angles, subject=trial.subject, condition=trial.condition)


def moments(
    walk: Walk,
    static: Trial | Path | str,
    mass_kg: float | None = None,
    sex: str = "",
    marker_set: Path | str | None = None,
    force_cutoff_hz: float = 20.0,
) -> Recording:
    """Compute joint moments and powers of a walk from its markers and force plates, by inverse dynamics.

    Parameters
    ----------
    walk : Trial, path, DataFrame, Recording or sequence of paths
        A walk with markers and ground forces.
    static : Trial or path
        Static trial of the same person with the same markers.
    mass_kg : float, optional
        Body mass [kg]; by default from the static C3D file.
    sex : str
        `f` or `m`, for the inertia of the segments; if empty, the mean of both.
    marker_set : str or path, optional
        Marker set, as in `angles`.
    force_cutoff_hz : float
        Low-pass of the ground force [Hz]; use 6 to filter it like the markers.

    Returns
    -------
    Recording
        Internal moments [N m/kg] and powers [W/kg]; NaN in frames in which a foot's load is unknown.

    Raises
    ------
    GaitdiscError
        If markers, forces or the mass are missing, no foot is alone on a force plate, or the plates show another mass
        in the static trial.

    References
    ----------
    Dumas, Cheze and Verriest 2007 (inertia of the segments).

    Examples
    --------
    >>> import gaitdisc as gd
    >>> gd.moments("walk.c3d", "static.c3d", mass_kg=70.0)["knee_angle_r_moment"]  # doctest: +SKIP
    """
    trial = make_trial(walk)
    standing, measures = _standing(static)
    weighed_n = standing_weight_n(standing)  # whoever stands on plates is weighed there
    person = Person(measures.mass_kg if mass_kg is None else mass_kg, sex, weighed_n)
    check_weight(weighed_n, person.kg, standing.name)
    moved = move_body(trial.stream("markers"), standing.stream("markers"), marker_set, measures)
    settings = KineticsSettings(force_cutoff_hz=force_cutoff_hz)
    return trial_kinetics(trial, moved.poses, find_foot_paths(moved), person, settings).moments


def _standing(static: Trial | Path | str) -> tuple[Trial, BodyMeasures]:
    """Return the static trial and the measures in its file."""
    if isinstance(static, Trial):
        return static, BodyMeasures()
    return read_trial(static), read_body_measures(Path(static))
