"""Folders that are made once for all processes of a test run."""

import fcntl
import os


def made_once(tmp_path_factory, name, make):
    """The folder with this name, which the first process that asks for it makes.

    `make` gets the folder, which is there and empty. Tests leave it unchanged.
    """
    base = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent
    folder, whole = base / name, base / f"{name}.whole"
    with open(base / f"{name}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not whole.exists():
            folder.mkdir()
            make(folder)
            whole.touch()
    return folder
