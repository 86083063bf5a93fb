"""`groundwalk list`: the known robots, servos, terrains, gaits and hidden effects."""

import dataclasses
from dataclasses import dataclass
from typing import Annotated

import tyro

import robots
from experiments.command_line import run_verb
from experiments.reports.tables import print_table
from groundwalk.errors import UnknownNameError
from robots.servos.types import servo_of, servo_types
from terrain.catalog import FAMILIES
from terrain.ground import Ground, Parameter
from walk_engine import PARAMETERS, gaits
from worlds.hidden import KINDS

UNITS = {"_rad": "rad", "_per_m2": "1/m2", "_m": "m"}
"""Unit of a terrain parameter by the ending of its name."""

Table = tuple[list[str], list[list[str]]]
"""The headings and the rows of a table of texts."""


def robot_table() -> Table:
    """Table of all robots: mass, leg length and number of joints."""
    rows = []
    for name in robots.names():
        robot = robots.get(name)
        leg = robots.biped(robot).leg
        leg_m = leg.thigh_m + leg.tibia_m + leg.ankle_height_m
        rows.append(
            [name, f"{robot.mass_kg:.3f}", f"{leg_m:.3f}", f"{len(robot.joints)}"]
        )
    return ["robot", "mass [kg]", "leg [m]", "joints"], rows


def terrain_table() -> Table:
    """Table of all terrains with their parameters; those that all share come last."""
    common = dataclasses.fields(Ground)
    known = {field.name for field in common}
    rows = []
    for name, family in sorted(FAMILIES.items()):
        rows.append([name, *[""] * 5, _summary(family)])
        own = [field for field in dataclasses.fields(family) if field.name not in known]
        rows += [["", *_bounds(field), ""] for field in own]
    rows.append(["every terrain", *[""] * 5, _summary(Ground)])
    rows += [["", *_bounds(field), ""] for field in common]
    headings = ["terrain", "parameter", "unit", "default", "from", "to", "what it is"]
    return headings, rows


def gait_table() -> Table:
    """Table of the gait parameters: value in each gait, bounds and meaning."""
    named = {name: gaits.get(name) for name in gaits.names()}
    rows = [
        [
            parameter.name,
            parameter.unit,
            *(f"{gait[parameter.name]:g}" for gait in named.values()),
            f"{parameter.low:g}",
            f"{parameter.high:g}",
            parameter.meaning,
        ]
        for parameter in PARAMETERS
    ]
    return ["parameter", "unit", *named, "from", "to", "what it does"], rows


def effect_table() -> Table:
    """Table of the hidden effects: possible places, and parameters."""
    rows = []
    for name, kind in KINDS.items():
        rows.append([name, f"@{kind.place}", _summary(type(kind))])
        for quantity in kind.quantities:
            optional = "" if quantity.default is None else ", optional"
            unit = "" if quantity.unit == "1" else f" {quantity.unit}"
            rows.append(["", quantity.name, f"{quantity.range_text}{unit}{optional}"])
    return ["effect", "where, with", "what it is; values"], rows


def servo_table() -> Table:
    """Table of the known servos at their usual supply and position gain."""
    headings = ["servo", "stiffness [N m/rad]", "torque limit [N m]", "source"]
    rows = []
    for name, variants in servo_types().items():
        for one in variants:
            text = f"{name}@{one.usual_volts:g}V,P={one.usual_p:g}"
            servo = servo_of(text)
            torque = f"{servo.max_torque_nm:.3g}"
            rows.append([text, f"{servo.kp_nm_rad:.3g}", torque, one.source])
    return headings, rows


TABLES = {
    "robots": robot_table,
    "terrains": terrain_table,
    "gaits": gait_table,
    "effects": effect_table,
    "servos": servo_table,
}


@dataclass(frozen=True)
class List:
    """List the known robots, servos, terrains, gaits or hidden effects.

    A terrain is given as its name, or with parameters as in
    lumps:amplitude_m=0.012,x_range_m=-1:8; a gait as its name or as a JSON file; a
    hidden effect with the name of a joint or body and all its parameters, as in
    backlash@LKneePitch:gap=0.02. Places other than joint and body need not be given.

    Attributes:
      kind: robots, servos, terrains, gaits or effects.
    """

    kind: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="KIND")]

    def __post_init__(self) -> None:
        """Refuse a list that does not exist."""
        if self.kind not in TABLES:
            raise UnknownNameError("list", self.kind, TABLES)


def main(config: List) -> None:
    """Print the list that the option `kind` names."""
    print_table(*TABLES[config.kind]())


def _bounds(field: "dataclasses.Field[Parameter]") -> list[str]:
    """Name, unit, default and bounds of a terrain parameter, as texts."""
    unit = next((UNITS[end] for end in UNITS if field.name.endswith(end)), "1")
    default = field.default if isinstance(field.default, tuple) else (field.default,)
    texts = [":".join(f"{value:g}" for value in default)]
    texts += [f"{bound:g}" for bound in field.metadata["bounds"]]
    return [field.name, unit, *texts]


def _summary(family: type) -> str:
    """The first line of a terrain's docstring."""
    return (family.__doc__ or "").partition("\n")[0]


if __name__ == "__main__":
    run_verb(List, main)
