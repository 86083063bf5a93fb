"""Reads a terrain that is written as one word on a command line."""

from groundwalk.errors import BadValueError
from terrain.bounds import Parameter
from terrain.catalog import configuration


def parse(text: str) -> tuple[str, dict[str, Parameter]]:
    """Read a terrain such as `lumps:amplitude_m=0.012,x_range_m=-1:8`.

    Args:
      text: a name, or a name, a colon and parameters separated by commas; the two
        ends of a range are separated by a colon.

    Returns:
      The name and the parameters in the text, for `terrain.make` and `TerrainSpec`.

    Raises:
      UnknownNameError: there is no such terrain, or it has no such parameter.
      BadValueError: the text has another form, or holds an impossible value.

    Example:
      >>> terrain.parse("stairs:steps=3")
      ('stairs', {'steps': 3})
    """
    name, colon, rest = text.partition(":")
    parameters: dict[str, Parameter] = {}
    for item in rest.split(",") if colon else ():
        parameter, equals, value = item.partition("=")
        if not equals:
            raise BadValueError(f"{item!r} in terrain {text!r} must be parameter=value")
        if parameter in parameters:
            raise BadValueError(f"{parameter} is given twice in terrain {text!r}")
        parameters[parameter] = _value(parameter, value)
    configuration(name, **parameters)
    return name, parameters


def _value(parameter: str, text: str) -> Parameter:
    """Read a parameter's value: a whole number, a number, or a range low:high."""
    try:
        if ":" in text:
            low, high = text.split(":")
            return float(low), float(high)
        return int(text) if text.lstrip("+-").isdecimal() else float(text)
    except ValueError:
        raise BadValueError(
            f"{parameter} must be a number or low:high, not {text!r}"
        ) from None
