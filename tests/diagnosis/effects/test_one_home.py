"""No product file compares effect names: an effect's class says what is asked of it."""

import ast
from pathlib import Path

from diagnosis.effects import all_effects

ROOT = Path(__file__).resolve().parents[3]
ROOMS = (
    "terrain", "robots", "walk_engine", "worlds", "sgat", "diagnosis", "experiments",
)  # fmt: skip
HOMES = ("diagnosis/effects/", "worlds/hidden/effects/")
DATA = {
    "diagnosis/corrected/joint_table.py": "a column, as other simulators call it",
    "experiments/concealed/draw.py": "pairs that are drawn together",
    "experiments/concealed/doctored/case.py": "what undoes a doctored label",
    "experiments/concealed/doctored/models.py": "what is taken from a model",
    "experiments/concealed/doctored/robots.py": "what each real set allows",
    "experiments/concealed/doctored/sizes.py": "how large each is drawn",
    "experiments/concealed/second/motion.py": "servos of two gains",
    "experiments/concealed/second/nuisance.py": "small mismatch in every case",
    "experiments/real_robot_study/cases.py": "what others published",
    "worlds/real/hidden_robot.py": "whose friction replaces that of the world",
}
"""Files that may name effects, and as what."""
GAIT = {"com_offset"}
"""A gait's parameter has an effect's name."""


def named(source):
    """Effect names among the constants of a module, f-strings included."""
    found = {
        node.value
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    return found & set(all_effects())


def test_effects_are_named_at_home_only():
    found = {
        f"{path.relative_to(ROOT)}: {', '.join(sorted(names))}"
        for room in ROOMS
        for path in (ROOT / room).rglob("*.py")
        if not str(path.relative_to(ROOT)).startswith(HOMES)
        if str(path.relative_to(ROOT)) not in DATA
        if (names := named(path.read_text()) - GAIT)
    }
    assert found == set()


def test_a_name_would_be_noticed():
    assert named('if placed.name == "backlash": pass') == {"backlash"}
    assert named('STIFF = frozenset({"joint_elasticity", "none"})') == {
        "joint_elasticity"
    }
    assert named('match name:\n    case "drag":\n        pass') == {"drag"}
    for path in DATA:
        assert named((ROOT / path).read_text()), path
