"""`groundwalk transfer`: the experiments of the SGAT paper, one study for each."""

from experiments.command_line import Verb

STUDIES = {
    "toy": Verb("transfer.toy", "TransferToy", "the paper's toy MDPs, solved exactly"),
    "cliff": Verb("transfer.cliff", "TransferCliff", "cliff walking over noise"),
    "inverted-pendulum": Verb(
        "transfer.gym_domains",
        "TransferInvertedPendulum",
        "a noisy pendulum with a heavier pole",
    ),
    "half-cheetah": Verb(
        "transfer.gym_domains", "TransferHalfCheetah", "noisy and heavier cheetahs"
    ),
    "nao": Verb("transfer.nao", "TransferNao", "gaits for uneven ground"),
    "nao-falls": Verb(
        "transfer.nao_falls",
        "TransferNaoFalls",
        "does the grounded sim know which gaits fall?",
    ),
}
"""The studies of this folder, by their names on the command line."""
