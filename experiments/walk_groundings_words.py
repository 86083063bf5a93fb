"""What the pages say of groundings that are not the paper's."""

from experiments.walk_groundings import UNEVEN

UNEVEN_MEANS = (
    f"{UNEVEN}: the sim has lumps of its own, as high as makes the gaits of the real",
    "walks fall as often there as they did on real ground; and the inverse model was",
    "fitted to next states as wrong as predicted ones are, so that it does not blow",
    "errors of a tick up to commands.",
)
