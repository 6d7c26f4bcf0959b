"""Gaitdisc: where a simulation or a model of walking and measured gait disagree, and what the difference is.

`import gaitdisc as gd` gives the names below; each is loaded when it is first used. What is stable in them is said in
docs/compatibility.md, and docs/library.md has four short scripts.
"""

from gaitdisc._version import __version__ as __version__

TYPE_CHECKING = False  # typing itself takes longer to load than all else here; type checkers know the name
if TYPE_CHECKING:
    from gaitdisc.channel import Channel as Channel
    from gaitdisc.comparison.mismatch import Mismatch as Mismatch
    from gaitdisc.discovery.result import Discovery as Discovery
    from gaitdisc.errors import GaitdiscError as GaitdiscError
    from gaitdisc.ingest.c3d import C3DReader as C3DReader
    from gaitdisc.ingest.reading import read_trial as read
    from gaitdisc.ingest.reading import write_recording as write
    from gaitdisc.library import plot as plot
    from gaitdisc.library.comparing import compare as compare
    from gaitdisc.library.comparing import paired_tests as paired_tests
    from gaitdisc.library.comparing import permutation_clusters as permutation_clusters
    from gaitdisc.library.discovering import discover as discover
    from gaitdisc.library.filters import differentiate as differentiate
    from gaitdisc.library.filters import envelope as envelope
    from gaitdisc.library.filters import highpass as highpass
    from gaitdisc.library.filters import lowpass as lowpass
    from gaitdisc.library.joints import angles as angles
    from gaitdisc.library.joints import moments as moments
    from gaitdisc.library.loading import check as check
    from gaitdisc.library.loading import load as load
    from gaitdisc.library.response import fit_response as fit_response
    from gaitdisc.library.simulating import simulate as simulate
    from gaitdisc.library.steps import contacts as contacts
    from gaitdisc.library.steps import contacts_by_detector as contacts_by_detector
    from gaitdisc.library.steps import cycles as cycles
    from gaitdisc.library.walks import example_files as example_files
    from gaitdisc.library.walks import example_walks as example_walks
    from gaitdisc.processing.inspection import Inspection as Inspection
    from gaitdisc.processing.pooled_cycles import PooledCycles as PooledCycles
    from gaitdisc.reconstruction.reconstruction import Reconstruction as Reconstruction
    from gaitdisc.reconstruction.reconstructor import Reconstructor as Reconstructor
    from gaitdisc.recording.field import Axis as Axis
    from gaitdisc.recording.field import Field as Field
    from gaitdisc.recording.recording import Finding as Finding
    from gaitdisc.recording.recording import Recording as Recording
    from gaitdisc.recording.samples import Samples as Samples
    from gaitdisc.recording.strides import Strides as Strides
    from gaitdisc.recording.trial import Event as Event
    from gaitdisc.recording.trial import Trial as Trial
    from gaitdisc.response.participant_response import ResponseRun as ResponseRun
    from gaitdisc.signals.contacts import Contacts as Contacts
    from gaitdisc.simulation.functions import simulation_from_function as simulation_from_function
    from gaitdisc.simulation.parts import Term as Term
    from gaitdisc.simulation.simulation import Simulation as Simulation
    from gaitdisc.simulation.simulation_file import bundled as bundled_simulation
    from gaitdisc.simulation.simulation_file import read_simulation as read_simulation
    from gaitdisc.simulation.writing import write_simulation as write_simulation
    from gaitdisc.statistics.holm_sidak import holm_sidak as holm_sidak
    from gaitdisc.statistics.r2 import r2 as r2
    from gaitdisc.statistics.signed_rank import signed_rank as signed_rank

# name -> module, and the name there; in the order of the reference
_HOME = {
    "read": ("ingest.reading", "read_trial"),
    "write": ("ingest.reading", "write_recording"),
    "C3DReader": ("ingest.c3d", "C3DReader"),
    "check": ("library.loading", "check"),
    "example_files": ("library.walks", "example_files"),
    "example_walks": ("library.walks", "example_walks"),
    "Trial": ("recording.trial", "Trial"),
    "Event": ("recording.trial", "Event"),
    "Recording": ("recording.recording", "Recording"),
    "Channel": ("channel", "Channel"),
    "Strides": ("recording.strides", "Strides"),
    "Samples": ("recording.samples", "Samples"),
    "Field": ("recording.field", "Field"),
    "Axis": ("recording.field", "Axis"),
    "Finding": ("recording.recording", "Finding"),
    "Inspection": ("processing.inspection", "Inspection"),
    "GaitdiscError": ("errors", "GaitdiscError"),
    "lowpass": ("library.filters", "lowpass"),
    "highpass": ("library.filters", "highpass"),
    "envelope": ("library.filters", "envelope"),
    "differentiate": ("library.filters", "differentiate"),
    "contacts": ("library.steps", "contacts"),
    "contacts_by_detector": ("library.steps", "contacts_by_detector"),
    "Contacts": ("signals.contacts", "Contacts"),
    "cycles": ("library.steps", "cycles"),
    "angles": ("library.joints", "angles"),
    "moments": ("library.joints", "moments"),
    "compare": ("library.comparing", "compare"),
    "Mismatch": ("comparison.mismatch", "Mismatch"),
    "Simulation": ("simulation.simulation", "Simulation"),
    "Term": ("simulation.parts", "Term"),
    "read_simulation": ("simulation.simulation_file", "read_simulation"),
    "write_simulation": ("simulation.writing", "write_simulation"),
    "bundled_simulation": ("simulation.simulation_file", "bundled"),
    "simulation_from_function": ("simulation.functions", "simulation_from_function"),
    "simulate": ("library.simulating", "simulate"),
    "discover": ("library.discovering", "discover"),
    "Discovery": ("discovery.result", "Discovery"),
    "fit_response": ("library.response", "fit_response"),
    "ResponseRun": ("response.participant_response", "ResponseRun"),
    "PooledCycles": ("processing.pooled_cycles", "PooledCycles"),
    "Reconstructor": ("reconstruction.reconstructor", "Reconstructor"),
    "Reconstruction": ("reconstruction.reconstruction", "Reconstruction"),
    "signed_rank": ("statistics.signed_rank", "signed_rank"),
    "paired_tests": ("library.comparing", "paired_tests"),
    "holm_sidak": ("statistics.holm_sidak", "holm_sidak"),
    "permutation_clusters": ("library.comparing", "permutation_clusters"),
    "r2": ("statistics.r2", "r2"),
    "load": ("library.loading", "load"),
    "plot": ("library.plot", ""),
}
__all__ = ["bundled_simulation", "read", "write"]  # by name: for a type checker an import is public only as `X as X`
__all__ += [name for name in _HOME if name not in __all__]


if not TYPE_CHECKING:  # or a type checker takes every misspelt name for one of ours

    def __getattr__(name: str) -> object:
        """Load a name when it is first used: `import gaitdisc` itself loads nothing."""
        if name not in _HOME:
            import sys

            # with the module Python adds the nearest name to the traceback
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name, obj=sys.modules[__name__])
        from importlib import import_module

        module, inside = _HOME[name]
        home = import_module(f"{__name__}.{module}")
        globals()[name] = getattr(home, inside) if inside else home
        return globals()[name]


def __dir__() -> list[str]:
    """Names of the library: no room that was loaded behind them."""
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])
