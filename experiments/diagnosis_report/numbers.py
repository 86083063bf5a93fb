"""Numbers as texts, with no more digits than are known, and in handy units."""

import math
from collections.abc import Iterable

from diagnosis.verdict import Amount, Estimate

DASH = "\N{EN DASH}"

_HANDY = {
    "s": (0.5, 1e3, "ms"),
    "m": (0.1, 1e3, "mm"),
    "1/s": (math.inf, 1e2, "% per second"),
}
"""By SI unit of a value: size below which it is printed in another unit, the factor to
that unit, and that unit."""
_ERRORS = {
    "rad": (0.1, 1e3, "mrad"),
    "m": (0.1, 1e3, "mm"),
    "rad/s": (0.1, 1e3, "mrad/s"),
}
"""By SI unit of an error: size below which it is printed in another unit, the factor to
that unit, and that unit."""


def estimate_text(estimate: Estimate) -> str:
    """A value with its interval, for example "0.030 rad (0.027 to 0.034)"."""
    size = max(abs(estimate.low), abs(estimate.high))
    factor, unit = _handy(_HANDY, estimate.unit, size)
    parts = estimate.value, estimate.low, estimate.high
    value, low, high = (factor * part for part in parts)
    if low == high:
        return f"{value:.3g} {unit}".rstrip()
    places = _decimals(high - low, abs(value))
    # adding 0.0 turns -0.0 into 0.0
    numbers = [f"{round(one, places) + 0.0:.{places}f}" for one in (value, low, high)]
    name = f" {unit}" if unit else ""
    return f"{numbers[0]}{name} ({numbers[1]} to {numbers[2]})"


def amount_text(amount: Amount) -> str:
    """A size with two digits and its unit, for example "0.0042 rad"."""
    factor, unit = _handy(_HANDY, amount.unit, amount.value)
    return f"{_two_digits(factor * amount.value)} {unit}".rstrip()


def error_unit(unit: str, largest: float) -> tuple[float, str]:
    """The factor that turns errors into a handy unit, and that unit.

    Args:
      unit: SI unit of the errors.
      largest: the largest error of those that are printed side by side, in `unit`.
    """
    return _handy(_ERRORS, unit, largest)


def errors_text(errors: Iterable[float | None]) -> list[str]:
    """Errors as texts with the same number of decimals; a dash for None."""
    given = list(errors)
    known = [abs(error) for error in given if error]
    places = 0
    if known:
        most = max(0, 3 - math.floor(math.log10(max(known))))
        places = min(_decimals(min(known) / 2, min(known)), most)
    return [DASH if error is None else f"{error:.{places}f}" for error in given]


def percent(part: float) -> str:
    """A share as text, for example "97 %"; "100 %" only where it is exactly 1."""
    text = f"{100 * part:.0f} %"
    if text == "100 %" and part < 1:
        return "over 99 %"
    return "under 1 %" if text == "0 %" and part > 0 else text


def sure_text(probability: float | None) -> str:
    """How sure an effect is, such as "97 % sure"; None is "not established"."""
    return "not established" if probability is None else f"{percent(probability)} sure"


def unit_text(unit: str) -> str:
    """A unit as it is printed: "" for the unit "1", and "m²" for "m^2"."""
    return {"1": ""}.get(unit, unit.replace("^2", "²").replace("^3", "³"))


def _handy(
    table: dict[str, tuple[float, float, str]], unit: str, size: float
) -> tuple[float, str]:
    below, factor, handy = table.get(unit, (0.0, 1.0, ""))
    return (factor, handy) if size < below else (1.0, unit_text(unit))


def _decimals(width: float, size: float) -> int:
    """Number of decimals that keep 1 or 2 digits of an interval's width (0: none)."""
    step = width if width > 0 else size / 100
    if step <= 0:
        return 0
    exponent = math.floor(math.log10(step))
    leading = step / 10.0**exponent
    return min(max(0, -exponent + (leading < 3)), 8)


def _two_digits(value: float) -> str:
    if value == 0:
        return "0"
    return f"{value:.{max(0, 1 - math.floor(math.log10(abs(value))))}f}"
