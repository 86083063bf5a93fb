"""Made-up truths, answers and oracles of concealed cases."""

from diagnosis.verdict import (
    Estimate,
    Found,
    PlacedEffect,
    Unexplained,
    Verdict,
)
from experiments.concealed.score import DIAGNOSIS, score_of
from experiments.concealed.scoring.answers import read_answer
from experiments.concealed.scoring.oracle import Oracle
from experiments.concealed.scoring.truth import TrueCase, Truth
from worlds.hidden.effects import Hidden

KNEE, HIP = "LKneePitch", "LHipPitch"
DRY = Hidden("coulomb_friction", KNEE, {"torque": 0.2})
WET = Hidden("viscous_friction", HIP, {"coefficient": 0.5})


def found(name, place, value=0.2, low=0.1, high=0.3, probability=0.95, others=()):
    parameter = {"coulomb_friction": "torque", "viscous_friction": "coefficient"}
    return Found(
        name,
        place,
        {parameter.get(name, "size"): Estimate(value, low, high, "1")},
        probability,
        tuple(PlacedEffect(other, place) for other in others),
    )


def names(*effects, **rest):
    return Verdict("effects", effects, **rest)


NOTHING = Verdict("none")
RIGHT = found("coulomb_friction", KNEE)
UNKNOWN = Verdict(
    "unknown",
    unexplained=Unexplained(0.5, "c", "rad", "p", "rad", (0.0,), (0.1,), (0.01,)),
)
UNSURE = Verdict("not_identifiable", limits=("the knee never moved",))


def oracle(gain=200.0, nominal=5.0, fitted=1.0, **answered):
    return Oracle(
        gain,
        nominal,
        fitted,
        {
            f"coulomb_friction@{KNEE}": {"torque": 0.0},
            f"viscous_friction@{HIP}": {"coefficient": 0.0},
        },
        {method: ("key", rms) for method, rms in answered.items()},
    )


def case(number, kind, *effects):
    return TrueCase("nao_air", "mujoco", kind, effects, name=f"case_{number:03d}")


def scored(*rows, method=DIAGNOSIS):
    """Score of a set from rows (kind, effects, verdict or None, oracle or None)."""
    cases = tuple(case(i, kind, *hidden) for i, (kind, hidden, _, _) in enumerate(rows))
    verdicts = {
        one.name: read_answer(row[2].to_json())
        for one, row in zip(cases, rows, strict=True)
        if row[2]
    }
    oracles = {one.name: row[3] for one, row in zip(cases, rows, strict=True) if row[3]}
    truth = Truth(7, {one.name: one for one in cases}, "ab12")
    return score_of(truth, {method: verdicts}, oracles)


def single(verdict, its_oracle=None):
    return ("single", (DRY,), verdict, its_oracle or oracle())
