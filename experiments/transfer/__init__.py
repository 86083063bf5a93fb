"""`groundwalk transfer`: the experiments of the SGAT paper, one study for each."""

from experiments.command_line import Verb

STUDIES = {
    "toy": Verb("TransferToy", "the paper's toy MDPs, solved exactly", "transfer.toy"),
    "cliff": Verb("TransferCliff", "cliff walking over noise", "transfer.cliff"),
    "inverted-pendulum": Verb(
        "TransferInvertedPendulum",
        "a noisy pendulum with a heavier pole",
        "transfer.gym_domains",
    ),
    "half-cheetah": Verb(
        "TransferHalfCheetah", "noisy and heavier cheetahs", "transfer.gym_domains"
    ),
    "nao": Verb("TransferNao", "gaits for uneven ground", "transfer.nao"),
    "nao-falls": Verb(
        "TransferNaoFalls",
        "does the grounded sim know which gaits fall?",
        "transfer.nao_falls",
    ),
}
"""The studies of `groundwalk transfer`, by their names on the command line."""
