"""What to do about the effects that a diagnosis found, at the robot or in the sim."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from diagnosis import Verdict
from diagnosis.corrected.mjcf import CORRECTED_XML
from diagnosis.effects import effect as kind_of
from diagnosis.verdict import Found
from experiments.diagnosis_report.corrected_files import how_simulated, why_in_no_file
from experiments.diagnosis_report.findings import at_number, told_together
from experiments.diagnosis_report.place_words import at_words


class Advice(NamedTuple):
    """What to do about one effect: its name and place, and sentences."""

    about: str
    robot: str
    """What to look at or to do at the robot; "" if nothing is known."""
    sim: str
    """Where the sim's own correction is."""


def advised(verdict: Verdict) -> Iterator[Advice]:
    """Advice on each effect that a verdict names; none if none is established.

    Example:
      >>> next(advised(verdict)).about
      'dry friction at the joint elbow'
    """
    if verdict.kind != "effects":
        return
    for group in told_together(verdict.effects):
        about = at_number(group) if len(group) > 1 else at_words(group[0])
        advice = kind_of(group[0].name).words.advice
        yield Advice(about, advice, _in_sim(group))


def _in_sim(group: Sequence[Found]) -> str:
    if all(one.native for one in group):
        return f"Or let the sim have it: {CORRECTED_XML} does."
    lacking = next(one for one in group if not one.native)
    told = how_simulated(lacking)
    return told if why_in_no_file(lacking) else f"Or let the sim have it. {told}"
