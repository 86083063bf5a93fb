"""Writes values over the times of one recording as columns of a Rerun file."""

from typing import TYPE_CHECKING, Any

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from worlds.scenes.curves import Trace

if TYPE_CHECKING:
    import rerun as rr


class ColumnLog:
    """Writes values over the same times, at entities below one path.

    Timelines: `sim_time`, the times themselves, and `tick`, their row.
    """

    def __init__(
        self, stream: "rr.RecordingStream", at: str, time_s: FloatArray
    ) -> None:
        """Write into a stream.

        Args:
          stream: of a recording.
          at: first part of all paths, with its "/"; may be empty.
          time_s: (ticks,) [s].
        """
        self._stream, self._at = stream, at
        # Rounded, because Rerun cuts off fractions of a nanosecond.
        self._time = np.rint(time_s * 1e9).astype("timedelta64[ns]")

    def log(self, path: str, what: "rr.AsComponents") -> None:
        """Log something that does not change over time."""
        self._stream.log(f"{self._at}{path}", what, static=True, strict=True)

    def trace(self, trace: Trace) -> None:
        """Log lines over time."""
        import rerun as rr

        self.log(trace.path, rr.SeriesLines(names=trace.names, colors=trace.lines))
        self.send(trace.path, rr.Scalars, scalars=trace.values)

    def send(self, path: str, kind: Any, **columns: FloatArray) -> None:
        """Send columns over time, without the rows in which a value is missing."""
        parts = [values.reshape(self._time.size, -1) for values in columns.values()]
        rows = np.flatnonzero(~np.isnan(np.hstack(parts)).any(axis=1))
        known = {name: values[rows] for name, values in columns.items()}
        if rows.size:
            self.send_rows(path, rows, kind.columns(**known))

    def send_rows(self, path: str, rows: IntArray, columns: Any) -> None:
        """Send values that are known at some of the times only.

        Args:
          path: of the entity.
          rows: indices of those times.
          columns: an archetype's columns, one value for each of the rows.
        """
        import rerun as rr

        indexes = (
            rr.TimeColumn("sim_time", duration=self._time[rows]),
            rr.TimeColumn("tick", sequence=rows),
        )
        self._stream.send_columns(f"{self._at}{path}", indexes, columns, strict=True)
