"""Learns the errors of a robot model from recordings of the healthy robot."""

from collections.abc import Sequence

from diagnosis.audit.audit import audit
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.search.hooks import Hooks
from diagnosis.search.judging import Judge
from diagnosis.search.result import pack_noise, unpack_noise
from diagnosis.search.rules import Rules
from diagnosis.search.search import Search
from diagnosis.traces.split import LEAST_FLOATING_S, shortened, split
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import FLOATING_WINDOW_S
from groundwalk.errors import BadRecordingError

MOST_S = 40.0
"""Most seconds used of all recordings of the healthy robot together [s]."""

CHECK_S = 6.0
"""Seconds of recordings of the healthy robot on which effects are checked: one that
gains there, too, is no change."""

SHIFTS = 3
"""Number of time offsets at which recordings on a floating base are cut into windows,
to get more windows from which to learn noise."""

REPLAYS = 40
"""Rough number of simulations for learning noise from recordings of the healthy robot;
only for the progress display."""


def learn_reference(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    rules: Rules | None = None,
    threads: int = 1,
    hooks: Hooks | None = None,
) -> ReferenceNoise:
    """Learn the difference between a robot model and the healthy robot.

    With a fixed base the effects that explain the difference are searched for first, as
    in any recording. A robot on a floating base differs from its model in every
    contact, which no effect describes; there all of the difference counts as noise.

    Args:
      plant: nominal robot model.
      traces: recordings of the healthy robot, at least one.
      channels: channels and their noise in the recordings to be diagnosed.
      rules: settings of the search; None for the default ones.
      threads: number of threads that simulate.
      hooks: progress display and checkpoint; None for neither.

    Raises:
      BadRecordingError: the recordings are unusable or too short to learn from.
    """
    refused = audit(traces, plant).refused
    if refused:
        raise BadRecordingError(f"the reference: {refused[0]}")
    hooks = (hooks or Hooks()).within("reference")
    traces = shortened(traces, MOST_S)
    model: tuple[PlacedEffect, ...] = ()
    if plant.base == "fixed":
        model = _explained(plant, traces, channels, rules, threads, hooks)
    hooks.stage("noise", REPLAYS)
    return _learned(plant, traces, channels, model, threads, hooks)


def _learned(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    model: tuple[PlacedEffect, ...],
    threads: int,
    hooks: Hooks,
) -> ReferenceNoise:
    """The errors that a model leaves in recordings, as noise."""

    def work() -> ReferenceNoise:
        count = len(channels.names)
        known = ReferenceNoise.known(model, count)
        floats = plant.base == "floating"
        every = [late for one in traces for late in _shifted(one)] if floats else traces
        options = None, threads, known, hooks.advance
        predictor = Predictor(plant, every, channels, *options)
        predictor.calibrate()
        residual = predictor.residuals([()])[0].reshape(-1, count)
        scored = predictor.scored.reshape(-1, count)
        return ReferenceNoise.of(model, residual, scored, predictor.blocks)

    return hooks.saved(work, pack_noise, unpack_noise)


def reference_checks(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    threads: int = 1,
    hooks: Hooks | None = None,
) -> list[Predictor]:
    """Predictors of recordings of the healthy robot, to reject effects seen there, too.

    An effect that explains as much of these recordings is no change. Each half of them
    is judged with the noise learned from the other half: with its own noise nothing
    would be left to explain. With a fixed base the list is empty: effects of the
    healthy robot are part of the nominal model there. Arguments are those of
    `learn_reference`.
    """
    if plant.base == "fixed":
        return []
    hooks = (hooks or Hooks()).within("reference check")
    hooks.stage("", 2 * REPLAYS)
    halves = _halves(shortened(traces, MOST_S))
    checks = []
    for own, other in (halves, halves[::-1]):
        some = shortened(own, CHECK_S / 2, LEAST_FLOATING_S)
        noise = _learned(plant, other, channels, (), threads, hooks)
        options = None, threads, noise, hooks.advance
        checks.append(Predictor(plant, some, channels, *options))
        checks[-1].calibrate()
    return checks


def _halves(traces: Sequence[Trace]) -> tuple[list[Trace], list[Trace]]:
    """Recordings in two parts; a single one is cut in the middle."""
    if len(traces) > 1:
        return list(traces[::2]), list(traces[1::2])
    (trace,) = traces
    middle = trace.ticks // 2
    return [trace.part(0, middle)], [trace.part(middle, trace.ticks)]


def reference_limit(noise: ReferenceNoise) -> tuple[str, ...]:
    """A sentence for the report: what the healthy robot shows is not searched for."""
    known = ", ".join(f"{one.name} at {one.place}" for one in noise.model)
    given = f" ({known})" if known else ""
    return (
        f"differences from the sim that the reference recordings show as well{given} "
        "are taken as given: only what has changed since is searched for",
    )


def _explained(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    rules: Rules | None,
    threads: int,
    hooks: Hooks,
) -> tuple[PlacedEffect, ...]:
    """The effects, with values, that a search finds in recordings."""
    parts = split(traces)
    fit, select = (*parts.fit, *parts.test), parts.select
    options = None, threads, None, hooks.advance
    whole = Predictor(plant, [*fit, *select], channels, *options)
    whole.calibrate()
    first, last = len(fit), len(fit) + len(select)
    judge = Judge(whole.part(0, first), whole.part(first, last), rules, hooks=hooks)
    winner = Search(judge).run().winner
    return winner.model if winner else ()


def _shifted(trace: Trace) -> list[Trace]:
    """A recording, and the same without its first 0.1 s and its first 0.2 s."""
    rows = FLOATING_WINDOW_S / SHIFTS / trace.tick_s
    firsts = [round(k * rows) for k in range(SHIFTS)]
    return [trace.part(k, trace.ticks) for k in firsts if trace.ticks > 2 * k]
