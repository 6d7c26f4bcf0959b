"""The named parts of a simulation."""

from dataclasses import dataclass

Lines = tuple[tuple[str, str], ...]  # name, expression
SECTIONS = ("definitions", "equations", "observations")  # of a simulation: those that are lines


@dataclass(frozen=True)
class State:
    """One component of the state vector."""

    name: str
    unit: str = "1"
    meaning: str = ""
    initial: float | None = None  # where it starts [unit]; estimated from each trial's first samples where absent


@dataclass(frozen=True)
class Input:
    """A measured signal that drives the simulation."""

    name: str  # one called `phase` of unit `1` is the share of the stride and wraps at 1
    unit: str = "1"
    meaning: str = ""
    # whether an engine computed it along the record (gaitdisc/engines): then it is part of the equations, and no
    # explanation of a gap changes it
    computed: bool = False
    gain: float | None = None  # standard deviation of what it errs by, as a share of it; exact where nothing is said
    sd: float | None = None  # the same, whatever its size [its unit]
    wander: float | None = None  # correlation time of these [s]; they stay as they are through the record where absent

    @property
    def wraps(self) -> bool:
        """Whether it goes from just below 1 to 0 without passing what lies between."""
        return self.name == "phase" and self.unit == "1"


@dataclass(frozen=True)
class Parameter:
    """A number of the model."""

    name: str
    value: float  # [unit]
    unit: str = "1"
    low: float | None = None  # what the user would believe [unit]
    high: float | None = None  # what the user would believe [unit]
    meaning: str = ""


@dataclass(frozen=True)
class Port:
    """A physical place where a missing effect may enter."""

    name: str
    unit: str = "1"
    meaning: str = ""


@dataclass(frozen=True)
class Term:
    """An effect added to a simulation.

    Parameters
    ----------
    place : str
        Port, or state to whose derivative the effect is added.
    kind : str
        Kind of the place: `port` or `equation`.
    name : str
        Name of the effect, such as `coulomb_friction`.
    term : str
        The added expression of states, inputs and parameters [unit of the place].

    Examples
    --------
    >>> import gaitdisc as gd
    >>> pendulum = gd.bundled_simulation("pendulum")
    >>> pendulum.with_effect(gd.Term("omega", "equation", "coulomb_friction", "-0.3*sign(omega)")).effects[0].place
    'omega'
    """

    place: str
    kind: str
    name: str
    term: str


@dataclass(frozen=True)
class Sensor:
    """How one observed channel was recorded.

    >>> Sensor("ankle_angle_r", "deg", sd=0.3).known, Sensor("theta").known
    (True, False)
    """

    channel: str
    unit: str = ""  # of the column; empty where it follows from the expression
    sd: float | None = None  # standard deviation of the sensor's noise, before any filter [unit]
    # Cut-off of the zero-lag low-pass that the record went through [Hz]: Butterworth of order 2, forwards and back; the
    # -3 dB frequency of one pass
    lowpass: float | None = None

    @property
    def known(self) -> bool:
        """Whether anything is said of it."""
        return bool(self.unit) or self.sd is not None or self.lowpass is not None
