"""Files that a user names: never overwritten."""

from pathlib import Path

from groundwalk.errors import BadValueError


def check_new(path: Path, suffix: str = "") -> None:
    """Refuse a path at which a file cannot be made.

    Args:
      path: as given with --out.
      suffix: what its name must end with.

    Raises:
      BadValueError: there is something already, or the name ends otherwise.
    """
    if path.exists():
        raise BadValueError(f"{path} exists already: choose another --out")
    if not path.name.endswith(suffix):
        raise BadValueError(f"{path} must end with {suffix}")
