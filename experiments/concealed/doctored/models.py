"""The model files of real robots as text, and how something is taken out of them."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from experiments.concealed.doctored.robots import RealSet
from groundwalk.errors import BadModelError
from robots.from_urdf.mesh_files import example_robots

ATTRIBUTES = {
    "viscous_friction": ("damping", "coefficient"),
    "coulomb_friction": ("frictionloss", "torque"),
}
"""For effects that an MJCF joint can have: its attribute, and their parameter."""


@dataclass(frozen=True, eq=False)
class RealModel:
    """The model file of a real robot, from which mass or friction can be taken.

    Shapes of a URDF are left out, since their meshes do not matter for the dynamics.

    Attributes:
      file: name of the file in the folder of a case.
      root: its XML; `take_mass` and `give` change it.

    Example:
      >>> RealModel.read(data, REAL_SETS["so101"]).file
      'nominal.urdf'
    """

    file: str
    root: Element

    @classmethod
    def read(cls, data: Path, real: RealSet) -> "RealModel":
        """Read the model of a robot; BadModelError if it is not there or no XML."""
        path = data / real.model
        if not path.suffix:
            known = example_robots()
            if real.model not in known:
                raise BadModelError(
                    f"the model of {real.model} is in example-robot-data, which is not "
                    "installed"
                )
            path = known[real.model]
        try:
            root = ElementTree.parse(path).getroot()
        except (ElementTree.ParseError, OSError) as error:
            raise BadModelError(f"{path} cannot be read: {error}") from error
        for link in root.iter("link"):
            for shape in [*link.findall("visual"), *link.findall("collision")]:
                link.remove(shape)
        return cls(f"nominal{path.suffix}", root)

    @property
    def text(self) -> str:
        """The model file as text."""
        return ElementTree.tostring(self.root, encoding="unicode") + "\n"

    def mass_kg(self, link: str) -> float:
        """Mass of a link."""
        return float(self._mass(link)[1])

    def take_mass(self, link: str, mass_kg: float) -> None:
        """Make a link lighter; its centre of mass and inertia about it stay.

        So the link lacks a point mass at its centre of mass.
        """
        element, own = self._mass(link)
        name = "value" if element.tag == "mass" else "mass"
        element.set(name, repr(own - mass_kg))

    def give(self, joints: Mapping[str, Mapping[str, float]]) -> None:
        """Set attributes of joints of an MJCF file, such as `damping`."""
        for joint, values in joints.items():
            for name, value in values.items():
                self._joint(joint).set(name, repr(value))

    def attribute(self, joint: str, name: str) -> float:
        """An attribute of a joint of an MJCF file, such as `damping`."""
        return float(self._joint(joint).get(name, "0"))

    def _joint(self, joint: str) -> Element:
        return self._found("joint", joint)

    def _mass(self, link: str) -> tuple[Element, float]:
        """The element that states a link's mass, and the mass [kg]."""
        if self.root.tag == "robot":
            element = self._found("link", link).find("inertial/mass")
            found = None if element is None else element.get("value")
        else:
            body = self._found("body", link)
            element = body.find("inertial")
            element = body.find("geom") if element is None else element
            found = None if element is None else element.get("mass")
        if element is None or found is None:
            raise BadModelError(f"{self.file} states no mass of {link}")
        return element, float(found)

    def _found(self, tag: str, name: str) -> Element:
        for element in self.root.iter(tag):
            if element.get("name") == name:
                return element
        raise BadModelError(f"{self.file} has no {tag} {name}")


def published(path: Path) -> dict[str, dict[str, float]]:
    """Published armature, damping and dry friction of joints, from a truth.json."""
    names = ["armature", *(attribute for attribute, _ in ATTRIBUTES.values())]
    return {
        one["place"]: {name: float(one["published"][name]) for name in names}
        for one in json.loads(path.read_text())["effects"]
    }
