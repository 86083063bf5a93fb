"""Opens `.rrd` files in Rerun's viewer."""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from groundwalk.errors import BadRecordingError, GroundwalkError

_PROGRAM = "rerun"


def open_viewer(paths: Sequence[Path]) -> "subprocess.Popen[bytes]":
    """Open Rerun files in a viewer window that stays open after this program ends.

    The viewer listens for more data; its default is all network interfaces, but here it
    listens on the loopback interface only, on a free port. It sends usage statistics to
    its makers unless `rerun analytics disable` has been run once. Returns its process.
    GroundwalkError if a file or the program `rerun` does not exist.

    Example:
      >>> open_viewer([Path("walk.rrd")])
    """
    for path in paths:
        if not path.is_file():
            raise BadRecordingError(f"{path}: no such file")
    # First beside this Python: its virtual environment may not be on the PATH.
    folders = (str(Path(sys.executable).parent), os.environ.get("PATH", ""))
    program = shutil.which(_PROGRAM, path=os.pathsep.join(folders))
    if program is None:
        raise GroundwalkError(
            f"the viewer cannot be opened: there is no program {_PROGRAM!r} beside "
            f"{sys.executable} or on the PATH; install rerun-sdk, or open "
            f"{', '.join(map(str, paths))} in a Rerun viewer elsewhere"
        )
    command = [program, "--bind", "127.0.0.1", "--port", "auto", *map(str, paths)]
    return subprocess.Popen(command, start_new_session=True)
