"""Decides whether dry friction stops joints, or lets them creep as MuJoCo's does.

Dry friction of real joints stops them. MuJoCo's constraint solver makes it softer, as
`solreffriction` and `solimpfriction` say, so that joints creep; recordings of a sim
show that. Whichever leaves less of the recordings is taken.
"""

from dataclasses import replace

from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.replays import Model, variants_of
from diagnosis.search.fitting import fit_all

CREEPS = (
    "These recordings fit better if dry friction lets joints creep, as MuJoCo's does "
    "with the solver parameters of this model, than if it stops them."
)
"""Sentence for the limits of a verdict."""


def rubs(plant: Plant, model: Model = ()) -> bool:
    """Whether dry friction acts at some joint of a robot model with effects."""
    variants = variants_of(plant, [model])
    dofs = list(plant.dofs)
    torque_nm = variants.field("dof_frictionloss")[0, dofs]
    return bool(torque_nm.any() or variants.joints.coulomb_nm.any())


def softly(plant: Plant) -> Plant:
    """The robot model whose dry friction lets joints creep."""
    return replace(plant, creeps=True)


def creeps(learned: Predictor, model: Model, least: float) -> bool:
    """Whether soft friction leaves less, by at least so much energy [nats].

    `learned` is a predictor of a robot model whose friction stops joints. The effects
    of the model are fitted with either friction.
    """
    soft, stiff = learned.on(softly(learned.plant)), learned.on(learned.plant)
    energies = []
    for one in (soft, stiff):
        one.doubt_as(learned)
        one.correct(model)
        near = one.moved_to(model)
        energies.append(fit_all(near, [model])[0].energy if model else _energy(near))
    return energies[1] - energies[0] > least


def _energy(predictor: Predictor) -> float:
    """What the nominal sim leaves [nats]."""
    (left,) = predictor.residuals([()])
    return 0.5 * float(left @ left)
