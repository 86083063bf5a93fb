"""All effects that a diagnosis can name, and how to add effects of your own."""

import contextlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from types import MappingProxyType

from diagnosis.effects import (
    angle_friction,
    bodies,
    controllers,
    friction,
    gear_friction,
    gears,
    ground,
    joints,
    presliding,
    ripple,
    sensors,
    servos,
    set_points,
    supply,
)
from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.traces.trace import Trace
from groundwalk.errors import BadValueError, UnknownNameError

BUILT_IN: Mapping[str, Effect] = MappingProxyType(
    {
        one.name: one
        for one in (
            friction.ViscousFriction(),
            friction.CoulombFriction(),
            friction.StribeckFriction(),
            friction.LoadFriction(),
            presliding.Presliding(),
            angle_friction.AngleFriction(),
            gear_friction.ShapedStribeck(),
            gear_friction.LoadedGear(),
            gear_friction.LoadedStribeck(),
            gear_friction.DirectionalGear(),
            gear_friction.QuadraticGear(),
            gears.Backlash(),
            gears.JointElasticity(),
            servos.CommandLatency(),
            sensors.SensorDelay(),
            sensors.LateReading(),
            joints.EncoderOffset(),
            sensors.GyroBias(),
            servos.TorqueLimit(),
            set_points.SpeedLimit(),
            set_points.AccelerationLimit(),
            servos.ServoGain(),
            servos.ServoDamping(),
            controllers.IntegralTerm(),
            controllers.DeadBand(),
            controllers.ErrorDerivative(),
            joints.Armature(),
            bodies.PayloadMass(),
            bodies.ComOffset(),
            bodies.LinkInertia(),
            joints.JointSpring(),
            joints.TorqueOffset(),
            ripple.Cogging(),
            joints.EndStop(),
            servos.ServoFade(),
            servos.ServoOff(),
            supply.SupplySag(),
            ground.ContactFriction(),
            ground.ContactCompliance(),
            ground.GroundSlope(),
            ground.UnevenGround(),
            bodies.ExternalForce(),
            bodies.Drag(),
            sensors.TorqueScale(),
        )
    }
)
"""The effects of this project by name. Their order matters: if two explain recordings
equally well, a verdict names the earlier one."""

_known: ContextVar[Mapping[str, Effect]] = ContextVar("effects", default=BUILT_IN)


def all_effects() -> Mapping[str, Effect]:
    """All effects by name that a diagnosis can find: built in or from `also_known`.

    Example:
      >>> all_effects()["backlash"].words.label
      'play (backlash)'
    """
    return _known.get()


def effect(name: str) -> Effect:
    """The effect with this name.

    Example:
      >>> effect("backlash").native
      False

    Raises:
      UnknownNameError: there is no such effect.
    """
    known = _known.get()
    if name not in known:
        raise UnknownNameError("effect", name, known)
    return known[name]


def grown_from(placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
    """More general effects that contain this one, at its place, with start values."""
    return tuple(
        grown for one in all_effects().values() for grown in one.grown_from(placed)
    )


def containing(placed: PlacedEffect) -> frozenset[str]:
    """Keys of all more general effects that contain this one, at once or by steps."""
    found, left = set[str](), [placed]
    while left:
        more = [one for one in grown_from(left.pop()) if one.key not in found]
        found.update(one.key for one in more)
        left += more
    return frozenset(found)


def keys_within(model: Iterable[PlacedEffect]) -> frozenset[str]:
    """Keys of the effects of a model, and of all simpler effects that they contain.

    Friction with a peak near standstill is dry friction as well, for example.
    """
    found, left = set[str](), list(model)
    while left:
        placed = left.pop()
        if placed.key not in found:
            found.add(placed.key)
            left += effect(placed.name).simpler(placed)
    return frozenset(found)


def lasts(placed: PlacedEffect, traces: Sequence[Trace]) -> bool:
    """Whether an effect acts in all recordings, and all the time in each."""
    first_s = min(float(trace.time_s[0]) for trace in traces)
    last_s = max(float(trace.time_s[-1]) for trace in traces)
    kind = effect(placed.name)
    if not kind.timed:
        return True
    acted = kind.acted(placed, first_s, last_s)
    return placed.recording is None and acted.kind == "always"


@contextlib.contextmanager
def also_known(*effects: Effect) -> Iterator[None]:
    """Let diagnoses in this `with` block find effects of your own, as if built in.

    Write reports on them in the block, too. Other threads and processes do not see the
    effects: start a thread's function by `contextvars.copy_context().run`, and open a
    block in the other process.

    Example:
      >>> with also_known(WaterDrag()):
      ...     found = diagnose(plant, traces, seed)

    Raises:
      BadValueError: two effects, given or built in, have the same name.
    """
    known = dict(_known.get())
    for one in effects:
        if one.name in known:
            raise BadValueError(f"there is an effect {one.name!r}; choose another name")
        known[one.name] = one
    token = _known.set(MappingProxyType(known))
    try:
        yield
    finally:
        _known.reset(token)
