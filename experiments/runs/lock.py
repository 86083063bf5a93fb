"""A lock on a run folder: no two processes write into one folder at the same time."""

import fcntl
import os
import weakref
from pathlib import Path
from typing import ClassVar, Self

from groundwalk.errors import RunFolderError

LOCK = ".lock"
"""Name of the lock file in a run folder; it holds the ID of the process."""


class FolderLock:
    """Keeps other processes out of a folder for as long as this object lives.

    The operating system releases the lock when the process dies, so that the folder of
    a killed run can be used at once. One process can lock the same folder repeatedly.

    Example:
      >>> lock = FolderLock.of(Path("runs/mine"))
      >>> del lock  # other processes may use the folder again
    """

    _held: ClassVar["weakref.WeakValueDictionary[Path, FolderLock]"] = (
        weakref.WeakValueDictionary()
    )

    def __init__(self, folder: Path) -> None:
        """Lock a folder. Call `of` instead: it reuses a lock of this process."""
        file = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            process = os.read(file, 20).decode() or "another"
            os.close(file)
            raise RunFolderError(
                f"{folder} is in use by process {process}: wait until it ends, or "
                "choose another folder"
            ) from None
        except OSError:
            pass  # a file system without locks, such as some network folders
        weakref.finalize(self, os.close, file)
        os.ftruncate(file, 0)
        os.write(file, str(os.getpid()).encode())

    @classmethod
    def of(cls, folder: Path) -> Self:
        """Lock a folder that exists.

        Raises:
          RunFolderError: another running process has locked it.
        """
        key = folder.resolve()
        lock = cls._held.get(key)
        if not isinstance(lock, cls):
            lock = cls._held[key] = cls(folder)
        return lock
