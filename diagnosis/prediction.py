"""Predicts recordings that nobody has fitted, by a robot's sim and its corrected sim.

The same is done as with the held-out recordings of a diagnosis (`tested.py`): the same
preparation, time steps, windows and start states. But nothing is fitted, since effects
and their values are given.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

from diagnosis.audit.result import Audit
from diagnosis.conclude.error_ratio import Squares, squares_of, summed
from diagnosis.conclude.held_out_series import HeldOutSeries, held_out_series
from diagnosis.conclude.soft_friction import softly
from diagnosis.material import Material
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import channel_unit
from diagnosis.residuals.data_sets import longest_window_s
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.steps import exact_steps, precise, with_best_steps
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.hooks import Hooks
from diagnosis.traces.reference import Reference
from diagnosis.traces.split import LEAST_FLOATING_S, LEAST_S, shortened, thinned
from diagnosis.traces.trace import DriveBy, Trace
from groundwalk.arrays import FloatArray
from groundwalk.blas import one_blas_thread
from groundwalk.errors import BadRecordingError

LONGEST_S = {"fixed": (300.0, LEAST_S), "floating": (30.0, LEAST_FLOATING_S)}
"""By the robot's base: most seconds of all recordings that are replayed, of which those
with the liveliest motion are taken, and seconds that are kept of each at least."""

TOO_SHORT = (
    "{name} is too short: it does not last longer than the influence of the state in "
    "which it starts"
)


@dataclass(frozen=True, eq=False)
class Prediction:
    """Recordings as predicted by a robot's sim before and after its correction.

    Attributes:
      plant: robot model that was replayed.
      before, after: effects of both sims; `before` is empty for the model as it is.
      sims: predictors of the recordings, each less its own integration error.
      audit: what the audit of the recordings found.
      limits: sentences on how the recordings were prepared.

    Example:
      >>> plant, traces = read_traces(["new.parquet"], "nao")
      >>> found = predict(plant, traces, load_correction("runs/knee", plant))
      >>> found.squares().ratios(np.random.SeedSequence(1))[0].value
    """

    plant: Plant
    before: Model
    after: Model
    sims: tuple[Predictor, Predictor]
    audit: Audit
    limits: tuple[str, ...]

    @property
    def channels(self) -> dict[str, tuple[float, str]]:
        """Noise floor and unit of each channel, by its name."""
        known = self.sims[0].channels
        return {
            name: (float(floor), channel_unit(self.plant, name))
            for name, floor in zip(known.names, known.floor, strict=True)
        }

    @property
    def traces(self) -> list[Trace]:
        """The recordings, or the part of each that was replayed."""
        return self.sims[0].traces

    def _left(self) -> tuple[FloatArray, FloatArray]:
        """(N,) errors of both sims [noise], less those of a wrong start state."""
        pairs = zip(self.sims, (self.before, self.after), strict=True)
        before, after = (sim.evenly().residuals([one])[0] for sim, one in pairs)
        return before, after

    def squares(self) -> Squares:
        """Squared errors of both sims in independent units of all recordings."""
        return squares_of(self.sims[0], *self._left())

    def squares_by_recording(self) -> Squares:
        """Squared errors of both sims in each recording."""
        sim = self.sims[0]
        return summed(sim, *self._left(), sim.trace, "recordings")

    def series(self) -> list[HeldOutSeries]:
        """Measured values of the recordings over time, and those of both sims."""
        return held_out_series(*self.sims, self.after, self.before)


@one_blas_thread
def predict(
    plant: Plant,
    traces: Sequence[Trace],
    after: Model,
    before: Model = (),
    drive: DriveBy = "servos",
    threads: int = 1,
    creeps: bool = False,
    hooks: Hooks | None = None,
) -> Prediction:
    """Predict recordings by a robot's sim, and by the sim with effects that were found.

    Args:
      plant: nominal robot model.
      traces: recordings of the robot, none of which has been fitted.
      after: effects of the corrected sim, see `corrected.effects_json.load_correction`.
      before: effects that the sim has before, as those of the healthy robot.
      drive: "servos": simulated servos follow the recorded commands; "torques": the
        measured torques act on the joints.
      threads: number of threads that simulate.
      creeps: whether dry friction lets joints creep, as a diagnosis may have said.
      hooks: progress display; None for none.

    Raises:
      BadRecordingError: the recordings cannot be used, or are too short.

    Example:
      >>> plant, traces = read_traces(["new.parquet"], "nao")
      >>> predict(plant, traces, load_correction("runs/knee", plant)).series()
    """
    hooks = hooks or Hooks()
    hooks.stage("audit", 1)
    none: Reference | None = None
    material = Material.of(softly(plant) if creeps else plant, traces, none, drive)
    plant = material.plant
    hooks.stage("noise", 1)
    channels = precise(plant, material.traces, material.channels, threads)
    hooks.stage("sim", 1)
    window_s = longest_window_s(plant, material.traces, channels, threads)
    parts, said = _affordable(plant, material.traces)
    parts = thinned(plant, parts, len(channels.names))
    options = None, threads, None, None, window_s
    sim = predictor_of(plant, parts, channels, *options)
    for k, trace in enumerate(sim.traces):
        if not sim.scored[sim.trace == k].any():
            raise BadRecordingError(TOO_SHORT.format(name=trace.recording))
    sim = with_best_steps(sim)
    nominal = exact_steps(copy(sim), before) if before else sim
    hooks.stage("corrected sim", 1)
    # a copy, since the integration error of another model is measured in it
    corrected = exact_steps(copy(sim), after)
    limits = (*material.audited.limits, *material.limits, *said)
    sims = nominal, corrected
    return Prediction(plant, before, after, sims, material.audited, limits)


def _affordable(
    plant: Plant, traces: Sequence[Trace]
) -> tuple[list[Trace], tuple[str, ...]]:
    """The recordings, cut to the liveliest parts if they are long; and a sentence."""
    longest_s, least_s = LONGEST_S[plant.base]
    total_s = sum(trace.duration_s for trace in traces)
    parts = shortened(traces, longest_s, least_s)
    if total_s <= longest_s:
        return parts, ()
    rest_s = sum(trace.duration_s for trace in parts)
    return parts, (
        f"Of {total_s:.0f} s of recordings the {rest_s:.0f} s with the liveliest "
        "motion were replayed.",
    )
