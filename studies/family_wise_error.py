"""How often the paired tests raise a false alarm where nothing differs: counted, not assumed.

    python studies/family_wise_error.py

Three models whose R2 are exchangeable are compared over participants in many studies without any effect, as
`compare_models` does it: exact signed rank, Holm-Sidak over the variables of a pair.
"""

from __future__ import annotations

from command_line import command_line

command_line(__name__, __doc__)  # before the slow imports

import numpy as np
from markdown_table import markdown_table
from numpy.typing import NDArray

import gaitdisc as gd

PAIRS = ((0, 1), (0, 2), (1, 2))
CASES = ((11, 8, 0.0), (11, 8, 0.8), (12, 8, 0.0), (8, 6, 0.0))


def p_of_sums(participants: int) -> NDArray[np.float64]:
    """Exact p of every smaller sum of ranks W, 0 to the largest."""
    found = []
    for w in range(participants * (participants + 1) // 4 + 1):
        differences, left = np.arange(1.0, participants + 1), w
        for rank in range(participants, 0, -1):
            if rank <= left:
                differences[rank - 1], left = -rank, left - rank
        found.append(gd.signed_rank(np.zeros(participants), differences).p)
    return np.array(found)


def false_alarms(
    participants: int, variables: int, correlation: float, studies: int = 20000, seed: int = 0
) -> dict[str, float]:
    """Share of studies without any effect in which at least one test says that two models differ."""
    rng = np.random.default_rng(seed)
    table = p_of_sums(participants)
    alarms = dict.fromkeys(("one pair", "pair", "all", "variable"), 0)
    for _ in range(studies):
        shared = np.sqrt(correlation) * rng.standard_normal((3, participants, 1))
        r2 = shared + np.sqrt(1 - correlation) * rng.standard_normal((3, participants, variables))
        differences = np.stack([r2[b] - r2[a] for a, b in PAIRS])
        ranks = np.abs(differences).argsort(axis=1).argsort(axis=1) + 1
        positive = np.where(differences > 0, ranks, 0).sum(axis=1)
        p = table[np.minimum(positive, ranks.sum(axis=1) - positive)]  # of the smaller sum of ranks
        by_pair = [bool(gd.holm_sidak(row).rejected.any()) for row in p]
        alarms["one pair"] += by_pair[0]
        alarms["pair"] += any(by_pair)
        alarms["all"] += bool(gd.holm_sidak(p).rejected.any())
        alarms["variable"] += any(gd.holm_sidak(column).rejected.any() for column in p.T)
    return {name: count / studies for name, count in alarms.items()}


if __name__ == "__main__":
    rows = [(*case[:2], f"{case[2]:g}", *map("{:.3f}".format, false_alarms(*case).values())) for case in CASES]
    head = "n | variables | correlation | one pair's family | three pairs | all tests | each variable's pairs"
    print(markdown_table(head, rows))
