"""`corrected_joints.csv`: values and intervals, by hand."""

import csv
import io

import pytest
from joint_rigs import servo_of

from diagnosis.corrected.joint_table import joints_csv
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.load import load_plant
from diagnosis.verdict import Estimate, Found

ELBOW = "elbow_flex"


@pytest.fixture(scope="module")
def arm():
    return load_plant("so101", "fixed")


def table(plant, model, found, servo=None):
    """Cells by joint and column."""
    rows = csv.DictReader(io.StringIO(joints_csv(plant, model, found, servo)))
    return {row["joint"]: row for row in rows}


def three(row, name, unit):
    return [row[f"{name}{end} [{unit}]"] for end in ("", " low", " high")]


def estimate(value, low, high):
    return Estimate(value, low, high, "1")


def test_values_add_to_the_models_and_intervals_come_from_the_effects(arm):
    servo = servo_of(len(arm.joints), *FACTORS)
    model = (
        PlacedEffect("armature", ELBOW, (0.02,)),
        PlacedEffect("servo_damping", ELBOW, (2.0,)),
        PlacedEffect("stribeck_friction", ELBOW, (0.1, 0.2, 0.1)),
        PlacedEffect("torque_limit", ELBOW, (1.5,)),
        PlacedEffect("command_latency", "commands", (0.01,)),
        PlacedEffect("viscous_friction", "gripper", (0.05,)),
    )
    found = [
        Found("armature", ELBOW, {"inertia": estimate(0.02, 0.015, 0.03)}, 0.9),
        Found(
            "stribeck_friction",
            ELBOW,
            {
                "coulomb_torque": estimate(0.1, 0.07, 0.13),
                "extra_torque": estimate(0.2, 0.16, 0.24),
                "speed": estimate(0.1, 0.05, 0.2),
            },
            0.9,
        ),
        Found("command_latency", "commands", {"delay": estimate(0.01, 0.0, 0.02)}, 0.9),
    ]
    rows = table(arm, model, found, servo)
    assert list(rows) == list(arm.joints)
    elbow, gripper = rows[ELBOW], rows["gripper"]
    assert three(elbow, "armature", "kg m^2") == ["0.02", "0.015", "0.03"]
    assert three(elbow, "friction", "N m") == ["0.1", "0.07", "0.13"]
    # 0.3 with errors of 0.03 and 0.04, which are those of a triangle of 0.05
    assert three(elbow, "friction at rest", "N m") == ["0.3", "0.25", "0.35"]
    assert three(elbow, "kp", "N m/rad") == ["17", "", ""]
    assert three(elbow, "kd", "N m s/rad") == ["1.2", "", ""]
    assert three(elbow, "damping", "N m s/rad") == ["0.6", "", ""]
    assert three(elbow, "torque limit", "N m") == ["1.5", "", ""]
    assert three(gripper, "torque limit", "N m") == ["2.9", "", ""]
    assert three(gripper, "damping", "N m s/rad") == ["0.35", "", ""]
    assert three(gripper, "delay", "s") == ["0.01", "0", "0.02"]
    assert three(gripper, "armature", "kg m^2") == ["0", "", ""]
    assert elbow["slides"] == "no"


def test_the_interval_is_that_of_what_is_new(arm):
    """The healthy robot had some of it, which is taken as given."""
    rub = "coulomb_friction"
    model = PlacedEffect(rub, ELBOW, (0.1,)), PlacedEffect(rub, ELBOW, (0.2,))
    found = [Found(rub, ELBOW, {"torque": estimate(0.2, 0.15, 0.3)}, 0.9)]
    cells = three(table(arm, model, found)[ELBOW], "friction", "N m")
    assert [float(cell) for cell in cells] == pytest.approx([0.3, 0.25, 0.4])
    elsewhere = [Found(rub, "gripper", {"torque": estimate(0.2, 0.1, 0.3)}, 0.9)]
    assert three(table(arm, model, elsewhere)[ELBOW], "friction", "N m")[1:] == ["", ""]


def test_nothing_is_below_zero(arm):
    """Clocks may be early, and links lighter than their model."""
    lighter = PlacedEffect("armature", ELBOW, (-1e-4,))
    early = PlacedEffect("command_latency", "commands", (-2e-4,))
    row = table(arm, (lighter, early), [])[ELBOW]
    assert (row["armature [kg m^2]"], row["delay [s]"]) == ("0", "0")


FACTORS = 17.0, 0.6, 2.9, 0.3
"""The servo's kp, kd, limit and back-EMF."""


def test_a_limit_that_the_model_lacks_is_infinite(tmp_path):
    path = tmp_path / "sled.xml"
    path.write_text("""<mujoco><worldbody><body><joint name="x" type="slide"/>
      <geom size="0.1"/></body></worldbody><actuator><position joint="x" kp="5"/>
      </actuator></mujoco>""")
    row = table(load_plant(path, "fixed"), (), [])["x"]
    assert row["slides"] == "yes"
    assert row["torque limit [N m]"] == "inf"
    assert row["kp [N m/rad]"] == "5"
