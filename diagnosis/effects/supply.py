"""The effect of a voltage supply that servos share and that gives way under load."""

from collections.abc import Sequence

from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.effects.places import joints_where
from diagnosis.effects.scales import speed_rad_s, torque_nm
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace, asked
from groundwalk.arrays import FloatArray

SUPPLY = "supply"
"""The place: the battery or power supply of all servos, with its cables."""


class SupplySag(Effect):
    """A supply whose voltage falls by a share at full load, and with it all servos.

    A motor of torque t and no-load speed w takes a current in proportion to |t| w. A
    servo's stiffness, damping and torque limit are in proportion to the voltage, so
    that all are 1 - share sum(|t| w) / sum(T w) times the nominal ones, with T the full
    torques. Back-EMF stays.

    Typical is a loss of up to 15 %.

    Source: motor and supply as resistances in series, Hughes and Drury 2019, "Electric
    motors and drives".
    """

    name = "supply_sag"
    shown_by = "poses"
    place_kind = "supply"
    native = False
    scales_servo = True
    rarity_nats = 1.0
    words = EffectWords(
        "supply that sags under load",
        "the servos' supply loses {share} of its voltage at full load of all, "
        "unlike {usual}",
        "Servos that work together take so much current that voltage is lost on the "
        "way, and all of them become weaker.",
        "Measure the voltage at the servos under load; take thicker or shorter cables, "
        "or a stronger supply.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The share of the voltage that is lost at full load."""
        return (Parameter("share", "1", 0.0, 0.9, 0.0, 0.15),)

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("supply",) if servos follow commands and all joints influence each other.

        Limbs that do not are simulated apart from each other, as if they had supplies
        of their own.
        """
        commanded = any(trace.command_rad is not None for trace in traces)
        is_whole = plant.base == "floating" or plant.model.ntree == 1
        if asked(traces) or not commanded or not is_whole:
            return ()
        servos = [plant.servo, *(trace.servo for trace in traces)]
        is_driven = any((one.kp_nm_rad > 0).any() for one in servos)
        return (SUPPLY,) if is_driven else ()

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Let each N m of any servo take its part of the voltage in one variant."""
        plant = copies.plant
        servos = joints_where(plant, [plant.servo.kp_nm_rad > 0]) or plant.joints
        speeds = {joint: speed_rad_s(plant, joint) for joint in servos}
        full_w = sum(torque_nm(plant, joint) * speeds[joint] for joint in servos)
        for joint in servos:
            taken = values[0] * speeds[joint] / full_w
            copies.joints.sag_1_nm[row, copies.column(joint)] += taken
