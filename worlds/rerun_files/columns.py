"""Writes values at the times of one recording as columns of a Rerun file."""

from typing import TYPE_CHECKING, Any

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from worlds.scenes.curves import Trace

if TYPE_CHECKING:
    import rerun as rr


class ColumnLog:
    """Writes values that share their times, as Rerun entities below one path.

    Rerun's timelines are `sim_time`, the times, and `tick`, their row from 0.
    """

    def __init__(
        self, stream: "rr.RecordingStream", at: str, time_s: FloatArray
    ) -> None:
        """Write into a Rerun stream.

        Args:
          stream: the stream of the file.
          at: first part of all paths, with a "/" at its end; may be empty.
          time_s: (ticks,) times of the values.
        """
        self._stream, self._at = stream, at
        # Rounded, because Rerun cuts off fractions of a nanosecond.
        self._time = np.rint(time_s * 1e9).astype("timedelta64[ns]")

    def log(self, path: str, what: "rr.AsComponents") -> None:
        """Write something that does not change over time to the entity `path`."""
        self._stream.log(f"{self._at}{path}", what, static=True, strict=True)

    def trace(self, trace: Trace) -> None:
        """Write lines over time, with their names and colours."""
        import rerun as rr

        self.log(trace.path, rr.SeriesLines(names=trace.names, colors=trace.lines))
        self.send(trace.path, rr.Scalars, scalars=trace.values)

    def send(self, path: str, kind: Any, **columns: FloatArray) -> None:
        """Write fields (ticks, ...) of the Rerun archetype `kind`, over time.

        Rows in which a value is NaN are left out.
        """
        parts = [values.reshape(self._time.size, -1) for values in columns.values()]
        rows = np.flatnonzero(~np.isnan(np.hstack(parts)).any(axis=1))
        known = {name: values[rows] for name, values in columns.items()}
        if rows.size:
            self.send_rows(path, rows, kind.columns(**known))

    def send_rows(self, path: str, rows: IntArray, columns: Any) -> None:
        """Write values that are known only at the times with the indices `rows`.

        `columns` are those of a Rerun archetype, with a value for each of these rows.
        """
        import rerun as rr

        indexes = (
            rr.TimeColumn("sim_time", duration=self._time[rows]),
            rr.TimeColumn("tick", sequence=rows),
        )
        self._stream.send_columns(f"{self._at}{path}", indexes, columns, strict=True)
