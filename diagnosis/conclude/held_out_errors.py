"""Errors on held-out recordings: of a diagnosis, and of wrong models as controls.

A diagnosis is convincing if all controls predict held-out recordings worse.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis.conclude.answer import alike
from diagnosis.conclude.controls import controls_of
from diagnosis.conclude.flexible_regression import flexible_regression_errors
from diagnosis.effects.library import containing, effect, keys_within
from diagnosis.residuals.channels import MORE_THAN_NOISE, channel_unit
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.chance import in_standard_errors, independent_blocks
from diagnosis.search.result import MOST_LEFT, SearchResult
from diagnosis.verdict import ChannelFit, Fit
from groundwalk.arrays import FloatArray

SURPRISE = 2.0
"""A verdict expresses a doubt if the rms error on held-out data is at least this
multiple of that on the data of the fit."""

FAINT = (
    "The held-out recordings hardly show the main effect: all recordings count in what "
    "it is judged by."
)
"""Sentence for the limits of a verdict."""


def held_out_errors(
    nominal: tuple[Predictor, Predictor],
    sims: tuple[Predictor, Predictor],
    searched: SearchResult,
    model: Model,
    least_shown: float,
    seed: np.random.SeedSequence,
) -> tuple[Fit, "Judgement"]:
    """Errors on held-out data: of the nominal sim, a model and wrong models (controls).

    The held-out data are used only here, after effects are chosen and fitted.

    Args:
      nominal: predictors of the data used so far (fitting and selection) and of the
        held-out data, both calibrated at the nominal robot model; see `beside_control`.
      sims: the same, calibrated at `model`. All of them have small mismatch of the
        nominal model, which is fitted anew to each control.
      searched: the result of the search.
      model: the effects that are reported, fitted to the data used so far.
      least_shown: energy [nats] of what the main effect changes from which on held-out
        data show it. Otherwise all data count in what effects are judged by: held-out
        motions need not meet an end stop, and hardly show what is faint.
      seed: seed of the flexible regression and of the random choice of a control.

    Returns:
      Errors as they are measured, and those by which to judge.
    """
    regression, lot = seed.spawn(2)
    controls = _controls(sims[0], searched, model, lot) if model else {}
    test, parts, said = sims[1], [1], tuple[str, ...]()
    if model and _shown(test, model, controls["without"]) < least_shown:
        parts, said = [0, 1], (FAINT,)
    elif model and test.knows_healthy_torques:
        parts = [0, 1]  # one recording has few independent means
    own = [sims[i] for i in parts]
    measured, judged = dict[str, FloatArray](), dict[str, FloatArray]()
    worse, follows = dict[str, float](), dict[str, float]()
    for key, one in {"nominal": (), "corrected": model, **controls}.items():
        pair = {"nominal": nominal, "corrected": sims}.get(key)
        pair = pair or beside_control(sims, model, one)  # takes memory
        some = [pair[i] for i in parts]
        measured[key] = _error([pair[1].evenly()], one)
        judged[key] = _error(some, one)
        if key in CONTROLS:
            worse[key] = _worse(own, model, some, one)
            follows[key] = share_that_follows(own, model, one, controls["without"])
    seeds = regression.spawn(2)
    even = nominal[0].evenly(), nominal[1].evenly()
    measured["ceiling"] = flexible_regression_errors(*even, seeds[0])
    if parts == [1]:
        judged["ceiling"] = flexible_regression_errors(*nominal, seeds[1])
    channels = test.channels
    wider = channels.noise / channels.floor, channels.wider
    fit = _fit(test, judged, wider[1])
    rms = _changed(own, model)
    changed = dict(zip(channels.names, rms.tolist(), strict=True))
    judgement = Judgement(
        fit,
        worse,
        said,
        hardly_more_than_noise(test),
        changed,
        follows,
        _own_channels(channels.names, model),
    )
    return _fit(test, measured, wider[0]), judgement


def _controls(
    both: Predictor, searched: SearchResult, model: Model, lot: np.random.SeedSequence
) -> dict[str, Model]:
    """The wrong models with which a model is compared, by their names."""
    others = [alike(searched, both.plant, placed) for placed in model]
    keys = {f"{one.name}@{one.place}" for own in others for one in own}
    keys |= {key for placed in model for key in containing(placed)}
    found = controls_of(both, model, keys, np.random.default_rng(lot))
    return {key: one for key, one in found.items() if one is not None}


@dataclass(frozen=True)
class Judgement:
    """Errors by which a model is judged.

    Attributes:
      fit: errors on held-out data, beyond what the jitter of clocks, wrong starts and
        other small mismatch of the nominal model may explain.
      worse: for each control (a wrong model), how much more it leaves than the model,
        in standard errors of that difference.
      limits: a sentence for the limits of the verdict if all data count.
      hardly_more: share of the squared noise up to which what is left above it is
        hardly more than noise.
      changed: for each channel, rms of what the model changes [noise].
      follows: for each control, the share of what the main effect explains that the
        control explains as well if the main effect is real.
      own: names of the channels of joints at which the model has effects.
    """

    fit: Fit
    worse: Mapping[str, float] = field(default_factory=dict)
    limits: tuple[str, ...] = ()
    hardly_more: float = MOST_LEFT
    changed: Mapping[str, float] = field(default_factory=dict)
    follows: Mapping[str, float] = field(default_factory=dict)
    own: tuple[str, ...] = ()


def _own_channels(names: Sequence[str], model: Model) -> tuple[str, ...]:
    """The channels, of those with these names, of joints at which a model has effects.

    Bodies may have the names of joints, but not their effects.
    """
    joints = {one.place for one in model if effect(one.name).place_kind == "joint"}
    return tuple(name for name in names if name.partition(".")[2] in joints)


def hardly_more_than_noise(test: Predictor) -> float:
    """Share of the squared noise that is hardly anything above it.

    How much of a torque's noise its smoothing leaves is known to a factor of two.
    """
    return MORE_THAN_NOISE**2 - 1 if test.by_torque else MOST_LEFT


CONTROLS = "wrong_place", "wrong_effect"
"""Names of the wrong models with which the one found is compared."""


def _worse(
    own: Sequence[Predictor], model: Model, others: Sequence[Predictor], control: Model
) -> float:
    """How much more a control leaves than a model, in standard errors.

    Energies of independent blocks of time are compared in pairs.
    """
    differences = []
    for one, other in zip(own, others, strict=True):
        (left,), (wrong,) = one.residuals([model]), other.residuals([control])
        block = independent_blocks(one, left)
        differences.append(np.bincount(block, wrong**2 - left**2))
    return in_standard_errors(np.concatenate(differences))


def share_that_follows(
    parts: Sequence[Predictor], model: Model, control: Model, rest: Model
) -> float:
    """Squared cosine of the angle between what a control and a model change.

    Both add one effect to the effects `rest`. So large a share of what the model's
    explains the control's explains, too, if the model is right.
    """
    products = np.zeros(3)
    for one in parts:
        without, own, other = one.residuals([rest, model, control])
        u, v = without - own, without - other
        products += u @ v, u @ u, v @ v
    return float(products[0] ** 2 / max(products[1] * products[2], 1e-300))


def _changed(parts: Sequence[Predictor], model: Model) -> FloatArray:
    """(c,) rms of what a model changes in parts of the data, in units of noise."""
    changes = [np.subtract(*one.residuals([model, ()])) for one in parts]
    return _rms(parts, changes)


def _shown(test: Predictor, model: Model, rest: Model) -> float:
    """Energy [nats] of what the effects that only `model` has change in data."""
    with_it, without = test.residuals([model, rest])
    return 0.5 * float(np.sum((with_it - without) ** 2))


def beside_control(
    sims: tuple[Predictor, Predictor], model: Model, control: Model = ()
) -> tuple[Predictor, Predictor]:
    """Predictors with the small mismatch that is likely beside a control.

    None is where a model has effects: what these explain is compared with what a
    control and the usual mismatch of other places and kinds explain, not with a part of
    the effects themselves. `sims` are of learned and of held-out data.
    """
    learned, test = sims
    if learned.nuisance is None:
        return sims
    keys = keys_within(model) - keys_within(control)
    none = learned.nuisance.none_at(keys)
    learned = learned.moved_to((*control, *none)).with_tolerances_beside(none)
    return learned, test.with_nuisance_of(learned).with_tolerances_beside(none)


def _fit(test: Predictor, errors: Mapping[str, FloatArray], wider: FloatArray) -> Fit:
    """Errors by channel and together, from rms errors (c,) in units of noise.

    `wider` (c,) is the noise in units of the floor.
    """
    channels, floor = {}, test.channels.floor
    for i, name in enumerate(test.channels.names):
        own = {key: float(rms[i] * wider[i] * floor[i]) for key, rms in errors.items()}
        unit = channel_unit(test.plant, name)
        channels[name] = ChannelFit(unit=unit, floor=float(floor[i]), **own)
    every = {
        key: float(np.sqrt(np.mean((rms * wider) ** 2))) for key, rms in errors.items()
    }
    return Fit(floor=1.0, channels=channels, **every)


def above_nominal(fit: Fit, nominal: Predictor) -> Fit:
    """The errors, beside those of the nominal sim as it is.

    `nominal` predicts the held-out data without any small mismatch of the model.
    """
    rms = _error([nominal], ())
    noise, floor = nominal.channels.noise, nominal.channels.floor
    channels = {
        name: replace(one, nominal=float(rms[i] * noise[i]))
        for i, (name, one) in enumerate(fit.channels.items())
    }
    every = float(np.sqrt(np.mean((rms * noise / floor) ** 2)))
    return replace(fit, nominal=every, channels=channels)


def _error(parts: Sequence[Predictor], model: Model) -> FloatArray:
    """(c,) rms error of a model on parts of the data, in units of noise."""
    return _rms(parts, [one.residuals([model])[0] for one in parts])


def _rms(parts: Sequence[Predictor], errors: Sequence[FloatArray]) -> FloatArray:
    """(c,) rms over parts of the data of errors (N,) in each, in units of noise."""
    each = zip(parts, errors, strict=True)
    rms = np.array([channel_rms(one, error) for one, error in each])
    rows = np.array([one.scored.sum() for one in parts])
    return np.asarray(np.sqrt(rows @ rms**2 / rows.sum()))


def channel_rms(predictor: Predictor, residual: FloatArray) -> FloatArray:
    """(c,) rms of each channel of an (N,) residual, both in units of noise."""
    c = len(predictor.channels.names)
    count = np.maximum(np.bincount(predictor.channel, predictor.scored, c), 1)
    return np.asarray(np.sqrt(np.bincount(predictor.channel, residual**2, c) / count))


def model_refuted(
    nominal: FloatArray, corrected: FloatArray, least_gain: float
) -> tuple[str, ...]:
    """A sentence for the limits if a model predicts held-out motions worse.

    `nominal` and `corrected` (N,) are residuals, in units of noise, of the nominal sim
    and of the sim with the effects found on the held-out data. `least_gain` [nats] is
    what an effect must gain to be reported.
    """
    if 0.5 * float(corrected @ corrected - nominal @ nominal) < least_gain:
        return ()
    return (
        "The effects found make the prediction of held-out motions worse: they explain "
        "a part of the error in the other recordings, but are not its cause.",
    )


def rms_above_floor(predictor: Predictor, residual: FloatArray) -> float:
    """Rms of an (N,) residual in the worst channel, in multiples of its noise floor."""
    rms = channel_rms(predictor, residual) * predictor.channels.wider
    return float(rms.max())


def larger_than_learned(
    learned: tuple[Predictor, FloatArray], test: tuple[Predictor, FloatArray]
) -> tuple[str, ...]:
    """A sentence for the limits if held-out errors are much larger than fitted ones.

    Each argument is a predictor and the residual (N,) that the model leaves there, in
    units of noise: of the data that it was fitted to, and of those held out.
    """
    before, after = max(rms_above_floor(*learned), 1.0), rms_above_floor(*test)
    if after < SURPRISE * before:
        return ()
    rms = channel_rms(*test)
    name = test[0].channels.names[int(np.argmax(rms))]
    return (
        f"The held-out recordings show more error than those that were fitted: "
        f"{after:.2g} instead of {before:.2g} times the noise, most of it in "
        f"{name}. Something is missing that hardly shows in the other recordings.",
    )
