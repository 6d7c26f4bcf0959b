"""How many sensors are enough, and which: every set of up to three, then the one that helps most, again and again."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError
from gaitdisc.reconstruction.state_errors import angle_columns
from gaitdisc.reconstruction.windows import Parts, thin_windows
from gaitdisc.recording import Samples, fit_scale
from gaitdisc.recording.arrays import Values

PENALTIES = tuple(10.0**power for power in range(-7, 1))
WHOLE_SEARCH = 3  # sensors; all sets of up to so many are tried, and beyond it one is added at a time
MOST_WINDOWS = 20_000
COLUMNS = ("sensors", "names", "loss", "rmse_deg", "fits", "seconds")


def search_sensors(people: Sequence[Parts], channels: Sequence[Channel], most: int = 4) -> pd.DataFrame:
    """Find the sensors from whose history ridge regression reconstructs all other states best, for all people together.

    Where there are angles, they alone are candidates and states: translations are not what a worn sensor measures.
    Sets are chosen on the check parts; the test parts have no say, their error stands beside the choice. Each set
    costs no pass over the windows: the mean products of all channels' histories are computed once for each person.

    people: windows in which every candidate is read, and every state reconstructed: both are the same channels
    returns: one row a size: `sensors` (how many), `names` (of the best set, joined by ", "), `loss` (mean squared
        error of all angles on the check parts, sensors counted as exact [deg2]; of the scaled states where there is no
        angle), `rmse_deg` (on the test parts, angles that no sensor measures; mean over people), `fits` and
        `seconds` (regressions and processor time for this size)
    """
    if most < 1 or len(channels) < 2:
        raise ChannelError(
            "a search must be for at least one sensor, among at least two channels",
            f"the number of sensors is {most}, that of channels {len(channels)}",
            "Use --search 1 or more, and recordings with more channels.",
        )
    begun = time.process_time()
    angles = angle_columns(channels)
    searched = tuple(angles) if len(angles) > 1 else tuple(range(len(channels)))
    products = [_products(parts, searched, bool(angles)) for parts in people]
    rows, best = [], ()
    for size in range(1, min(most, len(searched) - 1) + 1):
        more = (tuple(sorted((*best, k))) for k in searched if k not in best)
        losses = {
            chosen: float(np.mean([_errors(product, chosen)[0].sum() / len(product.kept) for product in products]))
            for chosen in (combinations(searched, size) if size <= WHOLE_SEARCH else more)
        }
        best = min(losses, key=lambda chosen: losses[chosen])
        names = ", ".join(channels[k].name for k in best)
        on_test = [float(np.sqrt(np.mean(_errors(product, best)[1]))) for product in products]
        now = time.process_time()
        rmse = float(np.mean(on_test)) if angles else float("nan")
        rows.append((size, names, losses[best], rmse, len(losses) * len(people), now - begun))
        begun = now
    return pd.DataFrame(rows, columns=pd.Index(COLUMNS))


Chosen = tuple[int, ...]
Part = tuple[Values, Values, Values]  # x x, x y, y y


@dataclass(frozen=True, eq=False)
class _Products:
    """Mean products of one person's scaled readings and states in the three parts: all that ridge regression needs."""

    fitted: Part
    checked: Part
    tested: Part
    weights: Values
    kept: Chosen


def _products(parts: Parts, searched: Chosen, in_deg: bool) -> _Products:
    training = thin_windows(parts.fitted(), MOST_WINDOWS)
    x_scale, y_scale = fit_scale(training.x), fit_scale(training.y)

    def of(samples: Samples) -> Part:
        some = thin_windows(samples, MOST_WINDOWS)
        x, y = x_scale.scaled(some.x), y_scale.scaled(some.y)
        return x.T @ x / len(x), x.T @ y / len(x), np.mean(y**2, axis=0)

    weights = y_scale.sd**2 if in_deg else np.ones(len(y_scale.sd))
    return _Products(of(training), of(parts.checked()), of(parts.tested()), weights, searched)


def _errors(products: _Products, chosen: Chosen) -> tuple[Values, Values]:
    """Mean squared error of each state that no sensor measures, on the check and on the test part."""
    count = len(products.weights)
    columns = np.flatnonzero(np.isin(np.arange(len(products.fitted[0])) % count, chosen))
    rest = np.setdiff1d(products.kept, chosen)
    fitted, checked, tested = (
        (x_x[np.ix_(columns, columns)], x_y[np.ix_(columns, rest)], y_y[rest])
        for x_x, x_y, y_y in (products.fitted, products.checked, products.tested)
    )
    values, vectors = np.linalg.eigh(fitted[0])
    turned = vectors.T @ fitted[1]
    weights = [vectors @ (turned / (np.maximum(values, 0.0)[:, None] + penalty)) for penalty in PENALTIES]
    losses = [_square(checked, weight) * products.weights[rest] for weight in weights]
    best = int(np.argmin([loss.sum() for loss in losses]))
    return losses[best], _square(tested, weights[best]) * products.weights[rest]


def _square(part: Part, weights: Values) -> Values:
    x_x, x_y, y_y = part
    return y_y - 2 * np.sum(weights * x_y, axis=0) + np.sum(weights * (x_x @ weights), axis=0)
