"""Which trials of a study get angles and moments from their markers, calibrated by the person's static trial."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gaitdisc.errors import GaitdiscError, ShapeError
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.ingest.study import FUNCTIONAL, STATIC, Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import calibration_trial
from gaitdisc.kinematics.calibration import Calibration, calibrate_body
from gaitdisc.kinematics.functional_hips import functional_hips
from gaitdisc.kinematics.marker_set import MarkerSet
from gaitdisc.kinematics.motion import choose_marker_set
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import KineticsSettings
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.processing.markers_to_moments import (
    ComputedTrial,
    compute_trial,
    with_segment_angles,
    without_exchanged_markers,
)
from gaitdisc.processing.side_checks import check_weight, standing_weight_n
from gaitdisc.processing.two_sources import without_contradicted
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.trial import BodyMeasures
from gaitdisc.signals.direction import marker_position
from gaitdisc.signals.emg import FEWEST, OVER_STANDING, OVER_WALKING, emg_sizes, other_unit_findings

SEGMENTS = (
    ("LASI", "RASI", "LPSI", "RPSI"),
    ("LASIS", "RASIS", "LPSIS", "RPSIS"),
    ("L.ASIS", "R.ASIS", "L.PSIS", "R.PSIS"),
    *((f"{side}KNE", f"{side}ANK") for side in "LR"),
    *((f"{side}KNE", f"{side}TIB") for side in "LR"),
    *((f"{side}HEE", f"{side}TOE") for side in "LR"),
    *((f"{side}.Knee.Lat", f"{side}.Ankle.Lat") for side in "LR"),
    *((f"{side}.Heel", f"{side}.Toe.Tip") for side in "LR"),
)
MOST_LOG_RATIO = 0.035  # between two distances
FEWEST_DISTANCES = 4  # fewer show nothing


def segment_distances(markers: Recording) -> dict[tuple[str, str], float]:
    """Median distance between markers that lie on one segment and are ever seen together: two markers -> [m]."""
    there = {name.rsplit(".", 1)[0] for name in markers.names}
    distances = {}
    for segment in SEGMENTS:
        for marker, other in itertools.combinations((name for name in segment if name in there), 2):
            apart = np.linalg.norm(marker_position(markers, marker) - marker_position(markers, other), axis=1)
            if np.isfinite(apart).any():
                distances[marker, other] = float(np.nanmedian(apart))
    return distances


def person_findings(static: Recording, walk: Recording, file: str) -> list[Finding]:
    """Say that a static trial is another person's, or that its markers were moved; nothing with few distances."""
    standing, walking = segment_distances(static), segment_distances(walk)
    both = [pair for pair in standing if pair in walking and min(standing[pair], walking[pair]) > 0]
    if len(both) < FEWEST_DISTANCES:
        return []
    apart = {pair: abs(np.log(walking[pair] / standing[pair])) for pair in both}
    worst = sorted(both, key=lambda pair: -apart[pair])[:2]
    if apart[worst[1]] < MOST_LOG_RATIO:
        return []
    moves = " and ".join(
        f"the distance from {marker} to {other} is {1000.0 * standing[marker, other]:.0f} mm when standing, but "
        f"{1000.0 * walking[marker, other]:.0f} mm in the walk"
        for marker, other in worst
    )
    what = f"the static trial is of another person, or its markers were moved: {moves}"
    return [Finding("warning", "static trial", file, what, "angles from these markers; name the correct static trial")]


Read = Callable[[PlannedTrial], Trial]
LEGS = ("hip_flexion", "knee_angle", "ankle_angle")
MODEL = ("kinematics", "moments")


@dataclass(eq=False)
class Standing:
    """The static trial of a person's session, and what is computed with it; what all walks share is said once."""

    study: Study  # with its `[kinematics]`
    participant: Participant
    planned: PlannedTrial | None
    markers: Recording | None
    unread: str = ""
    emg_sizes: Mapping[str, float] = field(default_factory=dict)
    circled: Recording | None = None
    weighed_n: float | None = None  # on the plates
    _calibrations: dict[str, Calibration] = field(default_factory=dict, init=False)
    _said: set[Finding] = field(default_factory=set, init=False)
    _walked: tuple[str, Mapping[str, float]] | None = field(default=None, init=False)

    def computed(self, planned: PlannedTrial, trial: Trial) -> ComputedTrial:
        """Trial with the angles that the study requests, and its steps on plates where moments were computed."""
        source = self.study.kinematics.angles if self.study.kinematics else ""
        trial = without_contradicted(trial if source == "markers" else self._without_exchanged(trial))
        trial = trial if source == "file" or "markers" in trial.streams else with_segment_angles(trial)
        angles = trial.streams["kinematics"].names if "kinematics" in trial.streams else ()
        of_legs = any(name[:-2] in LEGS for name in angles)
        if source == "file" or "markers" not in trial.streams or (not source and of_legs):
            return ComputedTrial(self._with_own_kinetics(planned, trial))
        bare = replace(trial, streams={key: value for key, value in trial.streams.items() if key not in MODEL})
        given_up = bare if source == "markers" else trial
        if self.markers is None:
            return ComputedTrial(given_up)
        try:
            calibration = self._calibration(self.markers, trial.stream("markers"))
        except GaitdiscError as error:
            return ComputedTrial(self._without_angles(given_up, self.participant.id, error))
        person, findings = self._person(planned, trial)
        settings = KineticsSettings(marker_cutoff_hz=self.study.filters.kinematics_hz)
        try:
            result = compute_trial(trial, calibration, person, settings)
        except GaitdiscError as error:
            return ComputedTrial(self._without_angles(given_up, trial.name, error))
        made = result.trial.findings[len(trial.findings) :]
        return replace(result, trial=replace(result.trial, findings=(*trial.findings, *self._new((*made, *findings)))))

    def _with_own_kinetics(self, planned: PlannedTrial, trial: Trial) -> Trial:
        """Trial with the moments of its file, but where the person weighs something else than they were divided by."""
        try:
            findings = check_weight(self.weighed_n, self.mass_kg(planned), trial.name)
        except GaitdiscError as error:
            findings = [Finding("warning", "no moments", trial.name, str(error).rstrip("."), "moments and powers")]
            trial = replace(trial, streams={key: stream for key, stream in trial.streams.items() if key != "moments"})
        return replace(trial, findings=(*trial.findings, *findings))

    def findings(self, trial: Trial, with_angles: bool) -> tuple[Finding, ...]:
        """What the static trial says of a walk: that it is another person's, of another unit, or that there is none."""
        units = tuple(self._unit_findings(trial))
        markers = trial.streams.get("markers")
        if markers is None:
            return units
        if self.markers is not None:
            return (*person_findings(self.markers, markers, trial.name), *units)
        severity = "note" if with_angles else "warning"
        spoils = "angles from markers" + ("; the angles of the file are used" if with_angles else "")
        return (Finding(severity, "static trial", trial.name, self.unread, spoils), *units)

    def _unit_findings(self, trial: Trial) -> list[Finding]:
        """Size of a walk's EMG beside that of the static trial, or of the session's first walk where that has none."""
        if "emg" not in trial.streams:
            return []
        walk_sizes = emg_sizes(trial.stream("emg"))
        if len(self.emg_sizes) >= FEWEST:
            return other_unit_findings(walk_sizes, self.emg_sizes, OVER_STANDING, trial.name, "the static trial")
        if self._walked is None:
            self._walked = trial.name, walk_sizes
            return []
        other, sizes = self._walked
        return other_unit_findings(walk_sizes, sizes, OVER_WALKING, trial.name, other)

    def mass_kg(self, planned: PlannedTrial) -> float | None:
        """Mass of the person: by the study, else the static file, else the walk's; None where none states one."""
        try:
            return self.participant.mass_kg or self._measures(self.planned).mass_kg or self._measures(planned).mass_kg
        except GaitdiscError:
            return None

    def body_weight_n(self, planned: PlannedTrial) -> float | None:
        """Weight of the person [N]: as stated, else as the static trial's plates have it; None without either."""
        mass = self.mass_kg(planned)
        return mass * GRAVITY if mass else self.weighed_n

    def leg_m(self, planned: PlannedTrial) -> float | None:
        """Leg length of the person [m]: as the static file or the walk's has it, else by the study's stature."""
        try:
            known = (self._measures(self.planned), self._measures(planned))
        except GaitdiscError:
            known = ()
        measured = next((body for body in known if body.leg_length_m), BodyMeasures(height_m=self.participant.height_m))
        return measured.leg_m or next((body.leg_m for body in known if body.leg_m), None)

    def _without_angles(self, trial: Trial, whose: str, error: GaitdiscError) -> Trial:
        finding = Finding("warning", "no angles", whose, str(error).rstrip("."), "angles from markers")
        return replace(trial, findings=(*trial.findings, *self._new((finding,))))

    def _without_exchanged(self, trial: Trial) -> Trial:
        """Trial of the file's own angles, without the frames in which its markers bear another's label."""
        if self.markers is None or not {"markers", "kinematics"} <= set(trial.streams):
            return trial
        try:
            checked = without_exchanged_markers(trial, self._calibration(self.markers, trial.stream("markers")))
        except ShapeError as error:
            return self._without_angles(trial, trial.name, error)
        except GaitdiscError:  # markers of no set that is known: nothing is checked
            return trial
        return replace(checked, findings=(*trial.findings, *self._new(checked.findings[len(trial.findings) :])))

    def _new(self, findings: Sequence[Finding]) -> tuple[Finding, ...]:
        """Those that no earlier trial has said."""
        new = tuple(finding for finding in dict.fromkeys(findings) if finding not in self._said)
        self._said.update(new)
        return new

    def _calibration(self, static: Recording, markers: Recording) -> Calibration:
        """Of the person, with the marker set that the study names or the labels are of."""
        wanted = self.study.kinematics
        named = wanted.marker_set if wanted else ""  # a file lies relative to the study's
        named_set = self.study.path_of(named) if named.endswith(".toml") else named or None
        chosen = choose_marker_set(markers, static, named_set)
        if chosen.name not in self._calibrations:
            marker_set = chosen.with_joints(wanted.joints) if wanted and wanted.joints else chosen
            marker_set = marker_set.with_hip(wanted.hip) if wanted and wanted.hip else marker_set
            self._calibrations[chosen.name] = self._calibrated(static, marker_set)
        return self._calibrations[chosen.name]

    def _calibrated(self, static: Recording, chosen: MarkerSet) -> Calibration:
        """Hips by function where a trial of the session shows them and the study names no others."""
        measures = self._measures(self.planned)
        body = calibrate_body(static, chosen, measures)
        if self.circled is None or (self.study.kinematics and self.study.kinematics.hip):
            return body
        try:
            hips, findings = functional_hips(self.circled, body)
        except GaitdiscError as error:
            file = self.circled.source.file or "the functional trial"
            note = Finding("warning", "functional hip", file, str(error).rstrip("."), "hip joint centres, by 1 to 2 cm")
            return replace(body, findings=(*body.findings, note))
        calibrated = calibrate_body(static, chosen, measures, hips) if hips else body
        return replace(calibrated, findings=(*calibrated.findings, *findings))

    def _person(self, planned: PlannedTrial, trial: Trial) -> tuple[Person | None, tuple[Finding, ...]]:
        """Mass and sex: the study's own, else the static file's, else the walk's; without a mass why not."""
        if "forces" not in trial.streams:
            return None, ()
        try:
            measures = self._measures(self.planned)
            mass = self.participant.mass_kg or measures.mass_kg or self._measures(planned).mass_kg
            findings = check_weight(self.weighed_n, mass, trial.name)
            return Person(mass, self.participant.sex, self.weighed_n), tuple(findings)
        except GaitdiscError as error:
            what = str(error).rstrip(".")
            return None, (Finding("warning", "no moments", self.participant.id, what, "moments and powers"),)

    def _measures(self, planned: PlannedTrial | None) -> BodyMeasures:
        """Mass and lengths in the C3D file of a trial; none where it is of other files."""
        if planned is None:
            return BodyMeasures()
        files = [file for file in planned.files if file.lower().endswith(".c3d")]
        return read_body_measures(self.study.path_of(files[0])) if files else BodyMeasures()


def find_standing(study: Study, participant: Participant, session: str, read: Read) -> Standing:
    """Markers of a session's static trial, or why there are none."""
    planned = calibration_trial(study, participant, session, STATIC)
    if planned is None:
        return Standing(study, participant, None, None, "there is no static trial")
    try:
        trial = read(planned)
    except GaitdiscError as error:
        return Standing(study, participant, planned, None, f"the static trial cannot be used: {error}")
    sizes = emg_sizes(trial.stream("emg")) if "emg" in trial.streams else {}
    circles = calibration_trial(study, participant, session, FUNCTIONAL)
    try:  # the trial in which the legs are circled about the hips; `check` says why it cannot be read
        circled = read(circles).streams.get("markers") if circles else None
    except GaitdiscError:
        circled = None
    markers, weighed_n = trial.streams.get("markers"), standing_weight_n(trial) if "markers" in trial.streams else None
    unread = "the static trial has no markers"
    return Standing(study, participant, planned, markers, unread, emg_sizes=sizes, circled=circled, weighed_n=weighed_n)
