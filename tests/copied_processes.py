"""Processes of tests, which begin as copies of one that has imported everything.

To import it anew takes each of them longer than most tests. `test_real` has
processes that begin as they do elsewhere.
"""

import multiprocessing
import os
import sys
import tempfile
from multiprocessing import forkserver
from pathlib import Path
from types import SimpleNamespace

import pytest

from experiments import concealed, transfer
from experiments.command_line import VERBS, home, main

IMPORTED = [
    *(home(*verb) for verb in VERBS.items()),
    *(home(*study) for study in (concealed.STUDIES | transfer.STUDIES).items()),
    "PIL.GifImagePlugin",
    "cma",
    "copied_processes",
    "jinja2",
    "matplotlib.backends.backend_agg",
    "matplotlib.pyplot",
    "mujoco",
    "networkx",
    "pyarrow.compute",
    "rerun.blueprint",
    "rich.markdown",
    "torch",
    "trimesh",
    "tyro",
    "worlds.real.world",
]


def copying():
    """The context of `multiprocessing` in which processes are such copies."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(IMPORTED)
    return context


def copy_instead(patch):
    """Let pools and the real world start copies; `patch` is a pytest.MonkeyPatch."""
    context = copying()
    multiprocessing_of_worlds = SimpleNamespace(get_context=lambda _: context)
    patch.setattr("worlds.real.world.multiprocessing", multiprocessing_of_worlds)
    patch.setattr("experiments.runs.processes.get_context", lambda _: context)


def groundwalk(folder, words):
    """Run `groundwalk WORDS` in a folder: the exit status, and what it printed."""
    with tempfile.NamedTemporaryFile() as said:
        process = started(folder, words, said.name)
        process.join()
        return process.exitcode, Path(said.name).read_text()


def nothing(patch):
    """What a process changes before it begins, unless it is told more."""


def started(folder, words, said=os.devnull, before=nothing):
    """The process of `groundwalk WORDS` in a folder, which prints into a file.

    It first calls `before` (of a module) with a pytest.MonkeyPatch.
    """
    arguments = (folder, words, said, before)
    process = copying().Process(target=_type_in, args=arguments)
    process.start()
    return process


def _type_in(folder, words, said, before):
    os.chdir(folder)
    for source, copies in ((os.devnull, [0]), (said, [1, 2])):
        file = os.open(source, os.O_RDWR)
        for number in copies:
            os.dup2(file, number)
    sys.argv = ["groundwalk", *words]
    patch = pytest.MonkeyPatch()
    copy_instead(patch)
    before(patch)
    # A copy does not know that the server that made it still runs.
    patch.setattr(forkserver._forkserver, "ensure_running", lambda: None)
    main()
