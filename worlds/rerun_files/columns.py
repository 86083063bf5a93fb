"""Writes columns of values over timelines into a Rerun file."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import rerun as rr

from groundwalk.arrays import FloatArray, IntArray
from worlds.scenes.curves import Trace


def tick_times(time_s: FloatArray) -> dict[str, npt.NDArray[Any]]:
    """Rerun's timelines (ticks,) of a recording: `sim_time`, and `tick`, from 0."""
    # Rounded, because Rerun cuts off fractions of a nanosecond.
    nanoseconds = np.rint(time_s * 1e9).astype("timedelta64[ns]")
    return {"sim_time": nanoseconds, "tick": np.arange(time_s.size)}


class ColumnLog:
    """Writes values that share their times, as Rerun entities below one path."""

    def __init__(
        self,
        stream: rr.RecordingStream,
        at: str,
        timelines: Mapping[str, npt.NDArray[Any]],
    ) -> None:
        """Write into a Rerun stream, at paths that begin with `at`.

        Of each timeline, there are (ticks,) times: durations or whole numbers.
        """
        self._stream, self._at, self._timelines = stream, at, timelines
        self._all = np.arange(len(next(iter(timelines.values()))))

    def log(self, path: str, what: rr.AsComponents) -> None:
        """Write something that does not change over time to the entity `path`."""
        self._stream.log(f"{self._at}{path}", what, static=True, strict=True)

    def trace(self, trace: Trace) -> None:
        """Write lines over time, with their names and colours."""
        self.log(trace.path, rr.SeriesLines(names=trace.names, colors=trace.lines))
        self.send(trace.path, rr.Scalars, scalars=trace.values)

    def send(self, path: str, kind: Any, **columns: FloatArray) -> None:
        """Write fields (ticks, ...) of the Rerun archetype `kind`, over time.

        Rows in which a value is NaN are left out.
        """
        parts = [values.reshape(self._all.size, -1) for values in columns.values()]
        rows = np.flatnonzero(~np.isnan(np.hstack(parts)).any(axis=1))
        known = {name: values[rows] for name, values in columns.items()}
        if rows.size:
            self.send_rows(path, kind.columns(**known), rows)

    def show(self, path: str, look: Any, columns: Any, rows: Any = None) -> None:
        """Write columns of a Rerun archetype at `rows`, and its constant `look`."""
        self.log(path, look)
        self.send_rows(path, columns, rows)

    def send_rows(self, path: str, columns: Any, rows: IntArray | None = None) -> None:
        """Write columns of a Rerun archetype at times numbered `rows` (k,), or all."""
        rows = self._all if rows is None else rows
        indexes = [
            rr.TimeColumn(name, duration=times[rows])
            if times.dtype.kind == "m"
            else rr.TimeColumn(name, sequence=times[rows])
            for name, times in self._timelines.items()
        ]
        self._stream.send_columns(f"{self._at}{path}", indexes, columns, strict=True)
