"""The option --load: known masses that a robot carried in a recording."""

from collections.abc import Iterable

from groundwalk.errors import BadRecordingError, BadValueError
from worlds import Load

EXAMPLE = "lever=1.02@0,0,-0.15"


def known_loads(texts: Iterable[str]) -> dict[str, Load]:
    """Loads by the body's name, from texts BODY=KG@X,Y,Z with metres in its frame.

    Raises:
      BadValueError: a text is not like that, or a body is named twice.

    Example:
      >>> known_loads(["lever=1.02@0,0,-0.15"])["lever"].mass
      1.02
    """
    found: dict[str, Load] = {}
    for text in texts:
        body, load = _load(text)
        if body in found:
            raise BadValueError(f"load names {body!r} twice; a body carries one load")
        found[body] = load
    return found


def _load(text: str) -> tuple[str, Load]:
    body, _, said = (part.strip() for part in text.partition("="))
    mass, _, place = said.partition("@")
    try:
        x, y, z = map(float, place.split(","))
        kg = float(mass)
    except ValueError:
        body = ""
    if not body:
        raise BadValueError(
            f"load is {text!r}; it must be BODY=KG@X,Y,Z, like {EXAMPLE}"
        )
    try:
        return body, Load(kg, (x, y, z))
    except BadRecordingError as error:
        raise BadValueError(f"load is {text!r}: {error}") from None
