"""Runs `groundwalk transfer` as a script: `python -m experiments.transfer STUDY`."""

import sys

from experiments.command_line import choose
from experiments.transfer import STUDIES

choose(STUDIES, "groundwalk transfer", sys.argv[1:], "study")
