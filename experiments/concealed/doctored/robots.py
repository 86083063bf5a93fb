"""The real robots whose recordings are doctored, and what may be made wrong at each."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from worlds.recordings.metadata import ServoGains

NOTHING = "nothing"
"""What is doctored in the cases in which nothing is."""
OUTSIDE = ("joints_swapped", "time_scale")
"""What a diagnosis has no effect for."""
IN_MODEL = ("payload_mass", "viscous_friction", "coulomb_friction")
"""What is taken out of the model; all else is made wrong in the recordings."""
_LABELS = ("servo_gain", "command_latency", "encoder_offset")


@dataclass(frozen=True)
class RealSet:
    """Recordings of one real robot, and what may be doctored.

    Attributes:
      folder: folder with the recordings, from the folder of all data.
      model: model file from the same folder, or the name of a robot of
        example-robot-data.
      share: share of the cases, before sets that are not there are left out.
      doctorings: what may be made wrong, by the names of the effects that follow; none
        that would hardly show even if it were large. () where nothing may be.
      gains: of all servos, where neither model nor recordings state them.
      files: pattern of the files that are used.
      pieces: number of pieces that each recording is cut into; 1 where there are enough
        recordings.
      unused: quantities that are left out, such as "command".
      turned: joints that turn a weight with a lever of 2 cm or more: at others, the
        encoder's zero does not matter.
      links: links with mass to take away, and for each a joint that moves its weight
        (or, without gravity, its mass).
      published: file with published armature, damping and friction of the joints, which
        the model is given before something is taken out of it; None for none.
      is_passive: whether nothing drives it: its swing tells more than any torque.
    """

    folder: str
    model: str
    share: float
    doctorings: tuple[str, ...]
    gains: ServoGains | None = None
    files: str = "*.parquet"
    pieces: int = 1
    unused: tuple[str, ...] = ()
    turned: tuple[str, ...] = ()
    links: Mapping[str, str] = field(default_factory=dict)
    published: str | None = None
    is_passive: bool = False

    @property
    def by_torque(self) -> bool:
        """Whether measured torques drive the model, and not servos."""
        return "command" in self.unused

    def there(self, data: Path) -> bool:
        """Whether a folder of data holds recordings of this set."""
        return any((data / self.folder).glob(self.files))


_LEGS = ("FL", "FR", "RL", "RR")
_LEG_JOINTS = tuple(
    f"{leg}_{part}_joint" for leg in _LEGS for part in ("hip", "thigh", "calf")
)
_LEG_LINKS = {
    f"{leg}_{part}": f"{leg}_{part}_joint"
    for leg in _LEGS
    for part in ("thigh", "calf")
}
_FRICTIONS = ("viscous_friction", "coulomb_friction")

REAL_SETS: Mapping[str, RealSet] = {
    "so101": RealSet(
        folder="so101",
        model="so101",
        share=0.28,
        doctorings=("command_latency", *OUTSIDE),
        # data sheet of the servo (Feetech STS3215) at 12 V, as in docs/diagnosis.md
        gains=ServoGains(7.8, 0.62, 2.94),
    ),
    "go2": RealSet(
        folder="go2",
        model="go2",
        share=0.14,
        doctorings=(*_LABELS, "payload_mass", *OUTSIDE),
        gains=ServoGains(20.0, 1.5, 23.7),  # stated with the recording
        pieces=4,
        turned=_LEG_JOINTS,
        links=_LEG_LINKS,
    ),
    "aliengo": RealSet(
        folder="labelled/aliengo_air",
        model="labelled/aliengo_air/model.xml",
        share=0.20,
        doctorings=(*_LABELS, "payload_mass", *_FRICTIONS, *OUTSIDE),
        files="recordings/*.parquet",
        pieces=2,
        turned=_LEG_JOINTS,
        links=_LEG_LINKS,
        published="labelled/aliengo_air/truth.json",
    ),
    "z1": RealSet(
        folder="labelled/z1_arm",
        model="labelled/z1_arm/model.xml",
        share=0.20,
        doctorings=(
            "servo_gain",
            "command_latency",
            "payload_mass",
            *_FRICTIONS,
            *OUTSIDE,
        ),
        files="recordings/*.parquet",
        pieces=2,
        links={
            "link02": "joint2",
            "link03": "joint3",
            "link04": "joint4",
            "link05": "joint4",
            "link06": "joint4",
            "gripperMover": "joint4",
        },
        published="labelled/z1_arm/truth.json",
    ),
    "emps": RealSet(
        folder="emps",
        model="emps/emps.xml",
        share=0.08,
        doctorings=("torque_scale",),
        files="sweep.parquet",  # the other one has pushes
        pieces=4,
        unused=("command",),  # the measured force drives the model
    ),
    "pendulum_known": RealSet(
        folder="labelled/pendulum_known",
        model="labelled/pendulum_known/model.xml",
        share=0.06,
        doctorings=("viscous_friction",),
        files="recordings/*.parquet",
        is_passive=True,
    ),
    "pendulum_viscous": RealSet(
        folder="labelled/pendulum_viscous",
        model="labelled/pendulum_viscous/model.xml",
        share=0.04,
        doctorings=(),
        files="recordings/*.parquet",
        is_passive=True,
    ),
}
"""The real robots by the name that the truth calls them. What looks like another change
is left out: the mass of a carriage on a level rail looks like rotor inertia. Of a
passive pendulum, mass at its centre of mass hardly changes the swing, a clock that is
too slow is more inertia, and a wrong zero is a tilted base."""
