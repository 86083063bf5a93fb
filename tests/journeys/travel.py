"""Runs the commands of a journey, each as its own process in one folder."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

from opened import open_all
from steps import NotRun, Run

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = {
    "groundwalk": [str(Path(sys.executable).with_name("groundwalk"))],
    "python": [sys.executable],
    "make": ["make", "-C", str(ROOT)],
}


def type_in(folder, command):
    """What a shell would do with a command: the finished process, and its output."""
    program, *words = shlex.split(command)
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    }
    return subprocess.run(
        [*PROGRAMS[program], *words],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )


def take(folder, command, step):
    """Run a step of a journey in a folder, and open what it wrote."""
    status = 0
    if isinstance(step, NotRun):
        command, status = step.brother, step.status
        step = Run(says=step.says)
    words = [word for word in command.split(" ") if word not in step.without]
    typed = " ".join([*words, step.options])
    done = type_in(folder, typed)
    said = f"{typed}\n{done.stdout}"
    assert done.returncode == status, said
    assert step.says in done.stdout, said
    assert "Traceback" not in done.stdout, said
    assert "is not written" not in done.stdout, said
    open_all(folder, step.writes)
