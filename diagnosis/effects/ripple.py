"""Torque that ripples with the angle of a joint."""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.base_kinds import TorqueEffect
from diagnosis.effects.parts import EffectWords, Parameter, Values
from diagnosis.effects.scales import torque_nm
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray

MOST_PER_TURN = 200.0
"""Most waves in a turn that are looked for. Motors cog some ten times in their own
turn, gears err once a tooth; of what is faster, inertia leaves little."""


class Cogging(TorqueEffect):
    """Torque A sin(n q + phase) on a joint at angle q, with n waves in a turn.

    An eccentric wheel or bearing gives one or two waves a turn of its own, magnets and
    teeth as many as there are; behind a gear n is that number times the gear's ratio.
    A joint has one such ripple here, the largest.

    Source: torque ripple of motors and gears, Holtz and Springob 1996, "Identification
    and compensation of torque ripple in high-precision permanent magnet motor drives".
    """

    name = "cogging"
    no_law = ""
    of_motor = False
    shown_by = "poses"
    main_parameters = ("torque",)
    rarity_nats = 5.0
    """Some 150 ripples can be told apart in 5 rad, and the one that fits noise best
    gains ln(150) nats more than one that was known beforehand."""
    words = EffectWords(
        "torque ripple (cogging)",
        "the torque at {joint} ripples by {torque}, {per_turn} times a turn (phase "
        "{phase}), {lacking}",
        "Magnets of a motor, teeth of a gear or an eccentric wheel help and hinder the "
        "motion in turn, always at the same angles.",
        "Count the ripples in a turn of motor or gear: as many teeth or magnets are to "
        "blame; one or two mean a wheel that runs out of true.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of all joints that turn."""
        every = super().places(plant, traces)
        return tuple(name for name in every if name not in plant.slides)

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Torque A [N m], waves n in a turn, and phase [rad] at the angle 0.

        A fit takes one wave more or less, and a radian of phase, for as much as a
        torque of 5 % of a large one.
        """
        scale = torque_nm(plant, place)
        return (
            Parameter("torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),
            Parameter("per_turn", "1", 1.0, MOST_PER_TURN, 12.0, 13.0),
            Parameter("phase", "rad", -7.0, 7.0, 0.0, 1.0),
        )

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Store the values for one variant; two ripples of as many waves are added.

        Of others, the waves are averaged by torque.
        """
        noted = copies.torque_values(self, len(values))[row, copies.column(place)]
        parts = np.array([noted, values])
        torques, waves, phases = parts.T
        if torques[1] == 0:
            return
        phasor = (torques * np.exp(1j * phases)).sum()
        per_turn = float(torques @ waves / torques.sum())
        noted[:] = np.abs(phasor), per_turn, np.angle(phasor)

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """The ripples that the recordings show most; () if the joint hardly turns."""
        found = usage.ripples.get(place, ())
        torque, *_ = self.parameters(plant, place)
        return [
            (min(max(size, 0.1 * torque.typical), torque.high), per_turn, phase)
            for size, per_turn, phase in found
        ]

    def torque_nm(
        self,
        values: FloatArray,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        time_s: FloatArray,
    ) -> FloatArray:
        """(rows, j) the torques; see `TorqueEffect`."""
        angle = values[..., 1] * position_rad + values[..., 2]
        return np.asarray(values[..., 0] * np.sin(angle))
