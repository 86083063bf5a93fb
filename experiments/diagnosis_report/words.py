"""Words for every effect that a diagnosis can name."""

import inspect
from typing import NamedTuple

from diagnosis.effects.effect import Effect
from diagnosis.effects.library import EFFECTS
from groundwalk.errors import UnknownNameError


class EffectWords(NamedTuple):
    """How people speak of an effect."""

    label: str
    """What it is called."""
    finding: str
    """A clause for one that was found, with the parameters' names for values, `{joint}`
    or `{body}` for a place; `{lacking}` reads "that the sim lacks", `{usual}` "in the
    sim"."""
    meaning: str
    """What it does, in one sentence."""

    @property
    def place_kind(self) -> str:
        """A joint or a body; empty if there is only one place where it can be."""
        kinds = ("joint", "body")
        return next((kind for kind in kinds if f"{{{kind}}}" in self.finding), "")


def effect_words(name: str) -> EffectWords:
    """The words for an effect.

    Raises:
      UnknownNameError: there is no effect of that name.
    """
    if name in WORDS:
        return WORDS[name]
    if name in EFFECTS:
        return _words_of(EFFECTS[name])
    raise UnknownNameError("effect", name, WORDS)


def _words_of(effect: Effect) -> EffectWords:
    """Words for an effect of somebody else's, made of its name and its docstring."""
    label = effect.name.replace("_", " ")
    kind = effect.place_kind
    where = f"{{{kind}}}" if kind in ("joint", "body") else "the robot"
    meaning = (inspect.getdoc(effect) or "").partition("\n")[0]
    return EffectWords(label, f"{where} has {label} {{lacking}}", meaning)


WORDS: dict[str, EffectWords] = {
    "viscous_friction": EffectWords(
        "viscous friction",
        "{joint} has viscous friction of {coefficient} {lacking}",
        "A torque against the motion that grows with speed, as in thick grease.",
    ),
    "coulomb_friction": EffectWords(
        "dry friction",
        "{joint} has dry friction of {torque} {lacking}",
        "A torque against the motion that is the same at all speeds; at rest it holds "
        "the joint until something stronger pulls.",
    ),
    "stribeck_friction": EffectWords(
        "dry friction that sticks (Stribeck)",
        "{joint} has dry friction of {coulomb_torque}, and {extra_torque} more below "
        "{speed}, {lacking}",
        "Dry friction that is larger near standstill than in motion, so that slow "
        "movements stick and slip.",
    ),
    "load_friction": EffectWords(
        "friction that grows with load",
        "{joint} has friction of {share} times its servo's torque {lacking}",
        "Gears and bearings rub harder the more torque passes through them.",
    ),
    "backlash": EffectWords(
        "play (backlash)",
        "{joint} has play of {gap} {lacking}",
        "Gears with a gap between their teeth: after each reversal the motor turns "
        "before the joint follows.",
    ),
    "joint_elasticity": EffectWords(
        "elastic joint",
        "{joint} is elastic between motor and link, with a stiffness of {stiffness} "
        "and a damping of {damping}, {lacking}",
        "A gear or shaft that winds up like a spring, so that the link lags behind its "
        "motor and rings.",
    ),
    "command_latency": EffectWords(
        "late commands",
        "commands take effect {delay} later than {usual}",
        "The time from sending a command until the servos act on it.",
    ),
    "sensor_delay": EffectWords(
        "late sensors",
        "joint positions and velocities are {delay} older than their time stamps say",
        "What the sensors report has already passed when it gets its time stamp.",
    ),
    "encoder_offset": EffectWords(
        "encoder offset",
        "the encoder of {joint} is off by {offset}",
        "Measured angle less true angle, as after mounting a servo horn one tooth "
        "aside; the servo acts on the wrong angle, too.",
    ),
    "gyro_bias": EffectWords(
        "gyroscope bias",
        "the gyroscope is off by {x} about x, {y} about y and {z} about z",
        "The gyroscope reports a turn rate even when nothing turns.",
    ),
    "torque_limit": EffectWords(
        "torque limit",
        "the motor of {joint} gives no more than {torque}, less than {usual}",
        "A motor that is weaker than the data sheet says, or a current limit.",
    ),
    "speed_limit": EffectWords(
        "speed limit",
        "the servo of {joint} moves its target no faster than {speed}, unlike {usual}",
        "A setting in the servo's firmware that slows its target down.",
    ),
    "servo_gain": EffectWords(
        "servo stiffness",
        "the servo of {joint} has {factor} times its stiffness {usual}",
        "The torque that the servo gives for each radian of error is another one.",
    ),
    "servo_damping": EffectWords(
        "servo damping",
        "the servo of {joint} has {factor} times its damping {usual}",
        "The torque with which servo and motor brake, for each rad/s, is another one.",
    ),
    "armature": EffectWords(
        "rotor inertia",
        "{joint} has {inertia} of rotor inertia {lacking}",
        "The motor's rotor, geared up, resists acceleration as a flywheel does.",
    ),
    "payload_mass": EffectWords(
        "extra mass",
        "{body} carries {mass} {lacking}",
        "A load, a battery or a cable that the model does not know of.",
    ),
    "com_offset": EffectWords(
        "shifted centre of mass",
        "the centre of mass of {body} is shifted from its place {usual} by {x} in x, "
        "{y} in y and {z} in z",
        "The mass is right, but sits elsewhere in the body.",
    ),
    "joint_spring": EffectWords(
        "spring at a joint",
        "{joint} has a spring of {stiffness} that pulls to {rest}, {lacking}",
        "A cable, a hose or a return spring pulls the joint to one angle.",
    ),
    "end_stop": EffectWords(
        "end stop",
        "{joint} hits a stop at {angle} {lacking}",
        "Something stops the joint before the end of its nominal range.",
    ),
    "servo_fade": EffectWords(
        "servo that weakens",
        "the servo of {joint} loses {rate} of its stiffness, unlike {usual}",
        "A motor that gets hot, or a battery that runs down, pulls less and less.",
    ),
    "contact_friction": EffectWords(
        "another grip of the ground",
        "the friction coefficient between feet and ground is {coefficient}, unlike "
        "{usual}",
        "The feet slip earlier, or later, than they should.",
    ),
    "contact_compliance": EffectWords(
        "soft ground",
        "the ground gives way under each foot with a stiffness of {stiffness} "
        "{lacking}",
        "Carpet, grass or rubber soles: the feet sink in and come back late.",
    ),
    "ground_slope": EffectWords(
        "tilt",
        "the ground, or the mounting of the base, is tilted by {pitch} in pitch and "
        "{roll} in roll",
        "Gravity does not point where the model has it.",
    ),
    "uneven_ground": EffectWords(
        "uneven ground",
        "the ground has bumps of {height} {lacking}",
        "The feet meet the ground earlier or later than on a plane.",
    ),
    "external_force": EffectWords(
        "push from outside",
        "{body} was pushed with {x} in x, {y} in y and {z} in z",
        "A hand, a cable or a collision pushes a body for some time.",
    ),
    "drag": EffectWords(
        "drag",
        "{body} meets a drag of {coefficient} {lacking}",
        "A force against the body's velocity, as of air, water or a trailing cable.",
    ),
}
