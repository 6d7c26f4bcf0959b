"""Gaitdisc: where a simulation or a model of walking and measured gait disagree, and what the difference is.

`import gaitdisc as gd` gives the names below; each is loaded when it is first used. What is stable in them is said in
docs/compatibility.md, and docs/library.md has four short scripts.
"""

# ruff: noqa: I001 names stand in the order of the reference

from gaitdisc._version import __version__ as __version__

TYPE_CHECKING = False  # typing itself takes longer to load than all else here; type checkers know the name
if TYPE_CHECKING:
    from gaitdisc.ingest.reading import read_trial as read
    from gaitdisc.ingest.reading import write_recording as write
    from gaitdisc.ingest.c3d import C3DReader as C3DReader
    from gaitdisc.library.loading import check as check
    from gaitdisc.library.walks import example_files as example_files
    from gaitdisc.library.walks import example_walks as example_walks
    from gaitdisc.recording.trial import Trial as Trial
    from gaitdisc.recording.trial import Event as Event
    from gaitdisc.recording.recording import Recording as Recording
    from gaitdisc.channel import Channel as Channel
    from gaitdisc.recording.strides import Strides as Strides
    from gaitdisc.recording.samples import Samples as Samples
    from gaitdisc.recording.field import Field as Field
    from gaitdisc.recording.field import Axis as Axis
    from gaitdisc.recording.recording import Finding as Finding
    from gaitdisc.processing.inspection import Inspection as Inspection
    from gaitdisc.errors import GaitdiscError as GaitdiscError
    from gaitdisc.library.filters import lowpass as lowpass
    from gaitdisc.library.filters import highpass as highpass
    from gaitdisc.library.filters import envelope as envelope
    from gaitdisc.library.filters import differentiate as differentiate
    from gaitdisc.library.steps import contacts as contacts
    from gaitdisc.library.steps import contacts_by_detector as contacts_by_detector
    from gaitdisc.signals.contacts import Contacts as Contacts
    from gaitdisc.library.steps import cycles as cycles
    from gaitdisc.library.joints import angles as angles
    from gaitdisc.library.joints import moments as moments
    from gaitdisc.library.comparing import compare as compare
    from gaitdisc.comparison.mismatch import Mismatch as Mismatch
    from gaitdisc.simulation.simulation import Simulation as Simulation
    from gaitdisc.simulation.parts import Term as Term
    from gaitdisc.simulation.simulation_file import read_simulation as read_simulation
    from gaitdisc.simulation.writing import write_simulation as write_simulation
    from gaitdisc.simulation.simulation_file import bundled as bundled_simulation
    from gaitdisc.simulation.functions import simulation_from_function as simulation_from_function
    from gaitdisc.library.simulating import simulate as simulate
    from gaitdisc.library.discovering import discover as discover
    from gaitdisc.discovery.result import Discovery as Discovery
    from gaitdisc.library.response import fit_response as fit_response
    from gaitdisc.response.participant_response import ResponseRun as ResponseRun
    from gaitdisc.processing.pooled_cycles import PooledCycles as PooledCycles
    from gaitdisc.reconstruction.reconstructor import Reconstructor as Reconstructor
    from gaitdisc.reconstruction.reconstruction import Reconstruction as Reconstruction
    from gaitdisc.statistics.signed_rank import signed_rank as signed_rank
    from gaitdisc.library.comparing import paired_tests as paired_tests
    from gaitdisc.statistics.holm_sidak import holm_sidak as holm_sidak
    from gaitdisc.library.comparing import permutation_clusters as permutation_clusters
    from gaitdisc.statistics.r2 import r2 as r2
    from gaitdisc.library.loading import load as load
    from gaitdisc.library import plot as plot

with open(__file__, encoding="utf-8") as _source:  # noqa: PTH123 pathlib takes longer to load than all else here
    _lines = [line.split() for line in _source if line.startswith("    from gaitdisc.")]  # what type checkers read
_HOME = {name: (module, inside) for _, module, _, inside, _, name in _lines}  # name -> module, and the name there
__all__ = ["bundled_simulation", "read", "write"]  # by name: for a type checker an import is public only as `X as X`
__all__ += [name for name in _HOME if name not in __all__]


if not TYPE_CHECKING:  # or a type checker takes every misspelt name for one of ours

    def __getattr__(name: str) -> object:
        """Load a name when it is first used: `import gaitdisc` itself loads nothing."""
        if name not in _HOME:
            import sys

            # with the module Python adds the nearest name to the traceback
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name, obj=sys.modules[__name__])
        module, inside = _HOME[name]
        globals()[name] = getattr(__import__(module, fromlist=[inside]), inside)
        return globals()[name]


def __dir__() -> list[str]:
    """Names of the library: no room that was loaded behind them."""
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])
