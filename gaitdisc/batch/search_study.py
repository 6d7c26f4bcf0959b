"""Search the sensors of a study: how many are enough for all its participants, and which."""

from __future__ import annotations

import pandas as pd

from gaitdisc.batch.reconstruct_study import ReconstructionSettings, parts_of
from gaitdisc.batch.sensed_walks import sensed_walks
from gaitdisc.batch.target_walks import STATES
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import Study
from gaitdisc.sensing.sensor_search import search_sensors
from gaitdisc.sensing.windows import windows_of


def search_study(study: Study, most: int, settings: ReconstructionSettings | None = None) -> pd.DataFrame:
    """Find the best sets of sensors among the states of a study, for all participants together.

    returns: as of `gaitdisc.sensing.sensor_search.search_sensors`
    """
    settings = settings or ReconstructionSettings()
    if settings.targets != STATES or settings.ahead_s:
        raise SchemaError(
            "sensors are searched for the states at their last reading",
            f"{settings.targets} are to be reconstructed {settings.ahead_s:g} s ahead",
            "Search without --targets and --ahead; then name the sensors with --sensors.",
        )
    walks = sensed_walks(study, (), settings.condition_read)
    names, lags = [channel.name for channel in walks.channels], settings.lags(walks.rate_hz)
    windows = {
        person: [windows_of(walk.recording, names, names, lags, walk.phi) for walk in found]
        for person, found in walks.people.items()
    }
    return search_sensors([parts_of(walks, windows, person, settings) for person in windows], walks.channels, most)
