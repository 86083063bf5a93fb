"""Draws the project's packages ("rooms") and subpackages ("shelves") as a picture.

    python docs/draw_rooms.py docs/architecture.png

A package is drawn above the packages that it may import; inside a large package the
same holds for its subpackages. The order comes from the import-linter contracts in
pyproject.toml, which `make lint` checks, so that the picture agrees with the code.
"""

import ast
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROOT = Path(__file__).resolve().parents[1]

WIDTH, LINE, TITLE, GAP = 12.0, 0.3, 0.42, 0.22
"""Width of the picture, height of a row of subpackages, height of a package's name, and
space between packages, all in inches."""
MOST_SAID = 70
"""Longest description of a package, in characters, that fits beside its name."""
ROOM, SHELF = "#dce6f2", "#ffffff"

Floors = list[list[str]]
"""Names of packages or subpackages in rows from the top down: each may import those of
lower rows, but not those of its own row."""


def floors(layers: Sequence[str]) -> Floors:
    """Split the layers of an import-linter contract into rows of package names.

    Args:
      layers: layers from the top down, such as "sgat | diagnosis"; brackets mark a
        package that may be missing.
    """
    return [
        [name.strip(" ()") for name in layer.replace(":", "|").split("|")]
        for layer in layers
    ]


def read_contracts() -> tuple[Floors, dict[str, Floors]]:
    """Read pyproject.toml: rows of packages, and rows of each package's subpackages."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    house: Floors = []
    shelves: dict[str, Floors] = {}
    for contract in project["tool"]["importlinter"]["contracts"]:
        if contract["type"] != "layers":
            continue
        rows = floors(contract["layers"])
        room = rows[0][0].partition(".")[0]
        if "containers" in contract:
            shelves[contract["containers"][0]] = rows
        elif room != rows[0][0]:
            shelves[room] = shelves_of(rows)
        else:
            house = rows
    return house, shelves


def shelves_of(rows: Floors) -> Floors:
    """Rows of subpackage names, each name once, from rows of dotted module names."""
    seen: set[str] = set()
    found: Floors = []
    for row in rows:
        names = dict.fromkeys(name.split(".")[1] for name in row)
        found.append([name for name in names if name not in seen])
        seen.update(names)
    return [row for row in found if row]


def says(room: str) -> str:
    """Purpose of a package: first line of its docstring, up to a colon if too long."""
    docstring = ast.get_docstring(ast.parse((ROOT / room / "__init__.py").read_text()))
    first = (docstring or "").splitlines()[0].rstrip(".")
    return first if len(first) < MOST_SAID else first.partition(":")[0]


def height(room: str, shelves: dict[str, Floors]) -> float:
    """Height of a package's box in the picture [in]."""
    return TITLE + LINE * len(shelves.get(room, ())) + 0.08


def draw(house: Floors, shelves: dict[str, Floors], path: Path) -> None:
    """Write the picture of the packages.

    Args:
      house: rows of packages, from the top down.
      shelves: rows of subpackages, by the name of their package.
      path: PNG file.
    """
    heights = [max(height(room, shelves) for room in floor) for floor in house]
    total = sum(heights) + GAP * (len(house) + 1)
    figure = Figure(figsize=(WIDTH, total), dpi=110)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, WIDTH), ylim=(0, total))
    axes.axis("off")
    top = total - GAP
    for floor, high in zip(house, heights, strict=True):
        wide = (WIDTH - GAP * (len(floor) + 1)) / len(floor)
        for k, room in enumerate(floor):
            left = GAP + k * (wide + GAP)
            own = height(room, shelves)
            _box(axes, (left, top - own), (wide, own), ROOM)
            axes.text(left + 0.14, top - 0.22, f"{room}/", weight="bold", va="center")
            purpose = {"size": 7.5, "ha": "right", "va": "center"}
            axes.text(left + wide - 0.14, top - 0.22, says(room), **purpose)
            _draw_shelves(axes, shelves.get(room, []), (left, top - TITLE), wide)
        top -= high + GAP
    figure.savefig(path)


def _draw_shelves(
    axes: "Axes", rows: Floors, corner: tuple[float, float], wide: float
) -> None:
    """Draw the rows of subpackages of one package, from its upper left corner [in]."""
    left, top = corner
    for k, row in enumerate(rows):
        each = (wide - 0.2) / len(row)
        for column, name in enumerate(row):
            at = (left + 0.1 + column * each + 0.03, top - (k + 1) * LINE + 0.03)
            _box(axes, at, (each - 0.06, LINE - 0.06), SHELF)
            middle = (at[0] + (each - 0.06) / 2, at[1] + (LINE - 0.06) / 2)
            axes.text(*middle, name, size=7, ha="center", va="center")


def _box(
    axes: "Axes", corner: tuple[float, float], size: tuple[float, float], colour: str
) -> None:
    style = "round,pad=0,rounding_size=0.06"
    axes.add_patch(
        FancyBboxPatch(
            corner, *size, boxstyle=style, facecolor=colour, edgecolor="#6b7a8f", lw=0.7
        )
    )


if __name__ == "__main__":
    draw(*read_contracts(), Path(sys.argv[1]))
