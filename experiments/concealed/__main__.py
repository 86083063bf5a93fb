"""Runs `groundwalk concealed` as `python -m experiments.concealed`."""

import sys

from experiments.command_line import choose
from experiments.concealed import STUDIES

choose(STUDIES, "groundwalk concealed", sys.argv[1:], "study")
