"""Makes the description of a walking robot from its URDF.

Legs, feet, arms and the direction in which the robot faces follow from the kinematics
(`limbs`), soles from collision shapes (`link_shapes`), motors from effort and speed
limits (`servo`), and the scaling of gaits from the leg length (`scale`). Joints of
legs and shoulders have motors; waist, neck, elbows, wrists and fingers are held still,
and their links are merged into the links above them.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from groundwalk.errors import BadModelError, BadValueError
from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Description, Foot, Imu, Joint, Link, Motor, VisualMesh
from robots.from_urdf.adaptation import Adaptation, urdf_path
from robots.from_urdf.limbs import (
    HIP_PART,
    Legs,
    ankles_ahead_m,
    crouch_rad,
    find_legs,
    find_shoulders,
    hanging_rad,
)
from robots.from_urdf.link_shapes import foot, round_shapes
from robots.from_urdf.mesh_files import mesh_path
from robots.from_urdf.posed_tree import PosedTree
from robots.from_urdf.urdf_tree import UrdfTree, read_urdf
from robots.leg_geometry import ANKLE, KNEE, ROLES, roles
from robots.scale import Scale


def adapted(name: str, adaptation: Adaptation, folder: Path) -> Description:
    """Describe the robot of a URDF, which `adaptation` names and completes.

    A relative path of the URDF refers to `folder`. GroundwalkError if the URDF is no
    robot on two legs; the message says why.
    """
    tree = read_urdf(urdf_path(adaptation.urdf, folder))
    placed = tree.placements({})
    legs = find_legs(tree, placed, adaptation)
    shoulders = find_shoulders(tree, placed, legs, adaptation.held)
    chosen = {*legs.left, *legs.right, *shoulders, *adaptation.moving}
    moving = tuple(joint for joint in tree.joints if joint in chosen)
    posed = PosedTree(tree, legs.turn, moving, _held_pose(tree, chosen, adaptation))
    return _Adapter(posed, legs, tuple(shoulders), adaptation).description(name)


def _held_pose(
    tree: UrdfTree, moving: set[str], adaptation: Adaptation
) -> dict[str, float]:
    """Angles [rad] of held joints by name: given, or nearest to zero in their range."""
    pose = {
        joint.name: float(np.clip(0.0, *joint.range_rad))
        for joint in tree.joints.values()
        if joint.moving and joint.name not in moving
    }
    return pose | {
        name: angle for name, angle in adaptation.pose_rad.items() if name not in moving
    }


@dataclass(frozen=True, eq=False)
class _Adapter:
    """Makes the parts of one robot's description from its URDF."""

    posed: PosedTree
    legs: Legs
    shoulders: tuple[str, ...]
    adaptation: Adaptation

    def description(self, name: str) -> Description:
        """Make the whole description of the robot."""
        hanging = [hanging_rad(self.posed, joint) for joint in self.shoulders]
        left, right = hanging or (0.0, 0.0)
        return Description(
            name=name,
            root=self._link(""),
            links=tuple(self._joint(joint) for joint in self.posed.moving),
            coupled=(),
            feet=self._feet,
            imu=Imu((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
            scale=self._scale,
            legs=self._columns,
            hanging_rad=(left, right),
            ankles_ahead_m=self._ankles_ahead_m,
        )

    @cached_property
    def _index(self) -> dict[str, int]:
        return {joint: i for i, joint in enumerate(self.posed.moving)}

    @cached_property
    def _columns(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Columns of the joints of both legs, from yaw to ankle roll."""
        given = self.adaptation.left_leg, self.adaptation.right_leg
        left, right = (
            tuple(self._index[joint] for joint in named or self._by_role(leg))
            for named, leg in zip(given, self.legs[:2], strict=True)
        )
        return left, right

    def _by_role(self, leg: tuple[str, ...]) -> list[str]:
        axes = np.array([self.posed.axis(joint) for joint in leg])
        try:
            return [leg[k] for k in roles(axes)]
        except ValueError as error:
            raise BadModelError(
                f"{self.posed.tree.path}: of {', '.join(leg)}, {error}: name the joints"
            ) from error

    @cached_property
    def _feet(self) -> tuple[Foot, Foot]:
        left, right = (
            foot(self.posed, leg[-1], self._index[leg[-1]], self.adaptation.sole, side)
            for leg, side in ((self.legs.left, 1), (self.legs.right, -1))
        )
        return left, right

    @cached_property
    def _sole_m(self) -> float:
        """Height z of the left sole in the root link's frame [m]."""
        ankle_m = self.posed.origin_m(self.legs.left[-1])
        return float(ankle_m[2]) + self._feet[0].sole_height_m

    @cached_property
    def _weight(self) -> tuple[float, float]:
        """Mass [kg], and height of the centre of mass above the soles [m]."""
        whole = self.posed.hanging("")
        return whole.mass_kg, float(whole.com_m[2]) - self._sole_m

    @cached_property
    def _scale(self) -> Scale:
        mass_kg, height_m = self._weight
        return Scale.of_robot(sum(self._bones_m), height_m, mass_kg)

    @cached_property
    def _bones_m(self) -> tuple[float, float, float]:
        """Thigh and shin length seen from the side, height of ankle above sole [m]."""
        pitch, knee, ankle = (
            self.posed.origin_m(self.posed.moving[self._columns[0][k]])
            for k in (ROLES.index("pitch"), KNEE, ANKLE)
        )
        thigh, shin = ((pitch - knee)[[0, 2]], (knee - ankle)[[0, 2]])
        above_m = float(ankle[2]) - self._sole_m
        return float(np.linalg.norm(thigh)), float(np.linalg.norm(shin)), above_m

    @property
    def _ankles_ahead_m(self) -> float:
        thigh_m, tibia_m, above_m = self._bones_m
        hip_m = HIP_PART * (thigh_m + tibia_m + above_m)
        pitch, knee = crouch_rad(thigh_m, tibia_m, hip_m - above_m)
        crouch = {joint: hanging_rad(self.posed, joint) for joint in self.shoulders}
        for leg in self._columns:
            for role, angle in ((2, pitch), (KNEE, knee), (ANKLE, -pitch - knee)):
                joint = self.posed.moving[leg[role]]
                crouch[joint] = math.copysign(angle, angle * self.posed.axis(joint)[1])
        return ankles_ahead_m(self.posed, crouch, self._feet[0], self._scale.length)

    def _joint(self, name: str) -> Joint:
        parent = self.posed.parent(name)
        own = self.posed.tree.joints[name].range_rad
        low, high = self.adaptation.range_rad.get(name, own)
        return Joint(
            name=name,
            parent=self._index.get(parent, -1),
            origin_m=self.posed.offset_m(name),
            axis=self.posed.axis(name),
            range_rad=(float(low), float(high)),
            motor=self._motor(name),
            link=self._link(name),
        )

    def _motor(self, name: str) -> Motor:
        joint, given = self.posed.tree.joints[name], self.adaptation
        effort = given.effort_nm.get(name, joint.effort_nm)
        speed = given.speed_rad_s.get(name, joint.speed_rad_s)
        load = None
        if name not in {*self.legs.left, *self.legs.right}:
            hanging, axis = self.posed.hanging(name), self.posed.axis(name)
            arm_m = np.cross(axis, hanging.com_m - self.posed.origin_m(name))
            load = float(axis @ hanging.inertia_kg_m2 @ axis)
            load += hanging.mass_kg * float(arm_m @ arm_m)
        try:
            return servo(effort or 0.0, speed or 0.0, *self._weight, load)
        except BadValueError as error:
            raise BadModelError(
                f"{self.posed.tree.path}: joint {name}: {error}"
            ) from error

    def _link(self, joint: str) -> Link:
        tree = self.posed.tree
        return Link(
            tree.joints[joint].child if joint else tree.root,
            self.posed.inertial(joint),
            round_shapes(self.posed, joint, -self._sole_m),
            self._meshes(joint),
        )

    def _meshes(self, joint: str) -> tuple[VisualMesh, ...]:
        """Existing mesh files of all links that move with a joint ("" for the root)."""
        shapes = [
            (self.posed.placed[link.name] @ shape.placement, shape.values)
            for link in self.posed.carried(joint)
            for shape in link.visual
            if shape.kind == "mesh"
        ]
        meshes = []
        for at, values in shapes:
            try:
                path = mesh_path(self.posed.tree.path, values["filename"])
            except BadModelError:
                continue
            x, y, z = (at.position_m - self.posed.origin_m(joint)).tolist()
            turn = Rotation.from_matrix(at.rotation).as_quat(scalar_first=True)
            w, i, j, k = turn
            along = [float(word) for word in values.get("scale", "1 1 1").split()]
            scale = along[0], along[1], along[2]
            meshes.append(VisualMesh(path, (x, y, z), (w, i, j, k), scale))
        return tuple(meshes)


IN_STANCE, FREE = (2.0, 0.19), (9.0, 0.5)
"""Natural frequency of a servo as a multiple of sqrt(g / h), and damping ratio, for
joints of legs and others. They come from the NAO in nao.toml: its legs' pitch joints
have kp = 59.9 N m/rad and kd = 1.216 N m s/rad, its shoulders 25.9 and 0.41 for an arm
of 0.008 kg m^2."""


def servo(
    effort_nm: float,
    speed_rad_s: float,
    mass_kg: float,
    height_m: float,
    hanging_kg_m2: float | None,
) -> Motor:
    """Choose a servo for a robot of whose motors only effort and speed are known.

    A joint of a leg has to hold the whole robot as an inverted pendulum on one ankle:
    with mass m and the centre of mass at h above the sole, the inertia is I = m h^2 and
    gravity topples it with m g h per radian. For a natural frequency w and a damping
    ratio z the gains are kp = I (w^2 + g / h) and kd = 2 z I w. Any other joint holds
    the links below it, with their inertia I, and the term g / h is left out. The
    frequency w is a multiple of sqrt(g / h), so that a robot of any size stands as
    firmly as the NAO.

    Stall torque and no-load speed are a URDF's joint limits. The back-EMF of such a
    motor is a damping of effort / speed; the servo's damping is never less. The rotor
    inertia is unknown and left out. Mass and height of the centre of mass above the
    soles are the robot's; `hanging_kg_m2` is the inertia of the links below the joint
    about its axis, None for a joint of a leg.
    """
    if not (effort_nm > 0 and speed_rad_s > 0):
        raise BadValueError(
            f"effort {effort_nm} N m and speed {speed_rad_s} rad/s must be positive"
        )
    own = math.sqrt(GRAVITY_M_S2 / height_m)
    if hanging_kg_m2 is None:
        (frequency, damping), inertia = IN_STANCE, mass_kg * height_m**2
        topple = own**2
    else:
        (frequency, damping), inertia, topple = FREE, hanging_kg_m2, 0.0
    w = frequency * own
    return Motor(
        stall_torque_nm=effort_nm,
        no_load_speed_rad_s=speed_rad_s,
        kp_nm_rad=inertia * (w**2 + topple),
        kd_nm_s_rad=max(2 * damping * inertia * w, effort_nm / speed_rad_s),
        rotor_kg_m2=0.0,
    )
