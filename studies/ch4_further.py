"""Chapter 4, 4.4 and 6.2.2 beyond their figures, on real people: bands, terms, a search, a curve, other outcomes.

    python studies/ch4_further.py [FOLDER] [--tables band people terms search curve moments energy] [--keep] [--quick]
    python studies/ch4_further.py --print TABLE

`band`: what 90 % bands from refits on blocks cover, of two runners; `people`: of forty simulated people, as `gaitdisc
run` fits them. `terms`: which terms of a sparse Discrepancy are selected in refits on random halves of 16 blocks,
beside a control. `search`: layers, nodes and activations by successive halving. `curve`: the Discrepancy over the
stride by Gaussian processes, random Fourier features and plain means. The last 12.5 % of each run are held out.

`moments`: six children walk straight and turn; Nominal is fitted to the other children's straight walks, Exo to their
turns, and each is scored on the turn of the child left out. `energy`: the power of eight people under nine settings of
an ankle exoskeleton from EMG and ground forces, by models of the others; null: the person's settings shuffled.
"""

from __future__ import annotations

from pathlib import Path

from command_line import tables_line

TABLES = ("band", "people", "terms", "search", "curve", "moments", "energy")
GIVEN = tables_line(__name__, __doc__, "ch4_further", TABLES)  # before the slow imports

from chapter4.outcomes import energy, moments
from chapter4.runners import band, curve, people, quartiles, search, terms
from further import Made, main

MADE = {
    "band": Made(band, "running, one person, last 12.5 % held out", "outputs"),
    "people": Made(
        lambda quick: quartiles(people(quick)),
        "90 % bands, 8 outputs a person, 60 s, last 12.5 % of device walking held out",
    ),
    "terms": Made(terms, "welk007, running, last 12.5 % held out"),
    "search": Made(search, "runs, ten outputs, last 12.5 % held out"),
    "curve": Made(curve, "Discrepancy of welk007, last 12.5 % held out", "outputs"),
    "moments": Made(moments, "stance, one child left out", "children"),
    "energy": Made(energy, "metabolic power, one person left out, own mean known; nine settings each"),
}

if __name__ == "__main__":
    main(GIVEN, MADE, Path(__file__).with_suffix(".csv"))
