"""Learning what was there when all was well from reference recordings."""

from collections.abc import Sequence

from diagnosis.audit.audit import audit
from diagnosis.effects.effect import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.reference_noise import Standing
from diagnosis.search.result import Rules
from diagnosis.search.search import Search
from diagnosis.traces.shorten import LEAST_FLOATING_S, shortened
from diagnosis.traces.split import split
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import FLOATING_WINDOW_S
from groundwalk.errors import BadRecordingError

MOST_S = 40.0
"""So much of the recordings is looked at."""

WELL_S = 6.0
"""So much is asked whether an effect was there before."""

SHIFTS = 3
"""Windows of a floating base begin at so many different rows: there are few of them."""


def standing_of(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    rules: Rules | None = None,
    threads: int = 1,
) -> Standing:
    """The standing difference between a plant and its robot.

    With a fixed base first the effects that explain it are searched for, as in any
    recording. A robot on its feet differs from its model in every contact, as no
    effect describes; all of that is taken as noise.

    Args:
      plant: nominal.
      traces: recordings of the robot when all was well, at least one.
      channels: with their noise, as in the recordings that are to be diagnosed.
      rules: of the search; the usual ones where None.
      threads: of the replays.

    Raises:
      BadRecordingError: nothing can be learned from these recordings.
    """
    refused = audit(traces, plant).refused
    if refused:
        raise BadRecordingError(f"the reference: {refused[0]}")
    traces = shortened(traces, MOST_S)
    model: tuple[PlacedEffect, ...] = ()
    if plant.base == "fixed":
        model = _explained(plant, traces, channels, rules, threads)
    return _learned(plant, traces, channels, model, threads)


def _learned(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    model: tuple[PlacedEffect, ...],
    threads: int,
) -> Standing:
    """What a model leaves of some traces."""
    count = len(channels.names)
    known = Standing.known(model, count)
    if plant.base == "floating":
        traces = [late for trace in traces for late in _shifted(trace)]
    predictor = Predictor(plant, traces, channels, threads=threads, standing=known)
    predictor.calibrate()
    residual, scored = predictor.residuals([()])[0], predictor.scored
    return Standing.of(
        model,
        residual.reshape(-1, count),
        scored.reshape(-1, count),
        predictor.blocks,
    )


def well_of(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    threads: int = 1,
) -> list[Predictor]:
    """What tells a robot on its feet that has changed from one that was always so.

    An effect that would have explained as much of the reference is none that is new.
    Each half of the reference is judged by what the other one shows: from its own
    standing difference nothing would be left to explain. With a fixed base such effects
    are part of the plant already.

    Args:
      plant: nominal.
      traces: the reference.
      channels: with their noise.
      threads: of the replays.
    """
    if plant.base == "fixed":
        return []
    halves = _halves(shortened(traces, MOST_S))
    wells = []
    for own, other in (halves, halves[::-1]):
        some = shortened(own, WELL_S / 2, LEAST_FLOATING_S)
        standing = _learned(plant, other, channels, (), threads)
        wells.append(
            Predictor(plant, some, channels, threads=threads, standing=standing)
        )
        wells[-1].calibrate()
    return wells


def _halves(traces: Sequence[Trace]) -> tuple[list[Trace], list[Trace]]:
    """Two parts of some traces, by whole ones if there are several."""
    if len(traces) > 1:
        return list(traces[::2]), list(traces[1::2])
    (trace,) = traces
    middle = trace.ticks // 2
    return [trace.part(0, middle)], [trace.part(middle, trace.ticks)]


def said_of(standing: Standing) -> tuple[str, ...]:
    """What a verdict has to say of it, in plain words."""
    known = ", ".join(f"{one.name} at {one.place}" for one in standing.model)
    given = f" ({known})" if known else ""
    return (
        f"what the reference recordings show as well{given} is taken as given: only "
        "what has changed since is looked for",
    )


def _explained(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    rules: Rules | None,
    threads: int,
) -> tuple[PlacedEffect, ...]:
    """The effects that a search finds."""
    parts = split(traces)
    fit, select = (*parts.fit, *parts.test), parts.select
    whole = Predictor(plant, [*fit, *select], channels, threads=threads)
    whole.calibrate()
    search = Search(
        whole.part(0, len(fit)), whole.part(len(fit), len(fit) + len(select)), rules
    )
    winner = search.run().winner
    return winner.model if winner else ()


def _shifted(trace: Trace) -> list[Trace]:
    """A trace, and the same without its first rows."""
    rows = FLOATING_WINDOW_S / SHIFTS / trace.tick_s
    firsts = [round(k * rows) for k in range(SHIFTS)]
    return [trace.part(k, trace.ticks) for k in firsts if trace.ticks > 2 * k]
