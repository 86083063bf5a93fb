"""`groundwalk transfer`: the experiments of the SGAT paper, a study each."""

import sys

from experiments.command_line import Verb, choose

STUDIES = {
    "toy": Verb("transfer_toy", "TransferToy", "the paper's toy MDPs, solved exactly"),
    "cliff": Verb("transfer_cliff", "TransferCliff", "cliff walking over noise"),
    "inverted-pendulum": Verb(
        "transfer_inverted_pendulum",
        "TransferInvertedPendulum",
        "a noisy pendulum with a heavier pole",
    ),
    "half-cheetah": Verb(
        "transfer_half_cheetah", "TransferHalfCheetah", "noisy and heavier cheetahs"
    ),
    "nao": Verb("transfer_nao", "TransferNao", "gaits for uneven ground"),
    "nao-falls": Verb(
        "transfer_nao_falls",
        "TransferNaoFalls",
        "does the grounded sim know which gaits fall?",
    ),
}
"""By their names on the command line."""

if __name__ == "__main__":
    choose(STUDIES, "groundwalk transfer", sys.argv[1:], "study")
