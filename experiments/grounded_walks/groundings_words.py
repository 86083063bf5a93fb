"""What the pages say of groundings that are not the paper's."""

from experiments.grounded_walks.methods import UNEVEN

UNEVEN_MEANS = (
    f"{UNEVEN}: chance has its place where it arises. The sim has lumps of its own, as",
    "high as makes the gaits of the real walks fall as often there, and sensors with",
    "the real ones' noise; commands cannot make a robot trip on flat ground. What is",
    "left, the joints, is grounded by one network that is fitted as a whole, so that",
    "after its commands a model of the sim does what the real joints did.",
)
