"""Runs the commands of a journey, each as its own process in one folder."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

from copied_processes import groundwalk
from kinds_of_steps import NotRun, Run
from opened import open_all

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = {"python": [sys.executable], "make": ["make", "-C", str(ROOT)]}


def type_in(folder, command):
    """What a shell would do with a command: its exit status, and what it printed."""
    program, *words = shlex.split(command)
    if program == "groundwalk":
        return groundwalk(folder, words)
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    }
    done = subprocess.run(
        [*PROGRAMS[program], *words],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout


def take(folder, command, step):
    """Run a step of a journey in a folder, and open what it wrote.

    Returns what it printed.
    """
    status = 0
    if isinstance(step, NotRun):
        command, status = step.brother, step.status
        step = Run(says=step.says)
    words = [word for word in command.split(" ") if word not in step.without]
    typed = " ".join([*words, step.options])
    done, printed = type_in(folder, typed)
    said = f"{typed}\n{printed}"
    assert done == status, said
    assert step.says in printed, said
    assert "Traceback" not in printed, said
    assert "is not written" not in printed, said
    open_all(folder, step.writes)
    return printed
