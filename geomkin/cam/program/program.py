"""The motion programme of a cam: segments that fill one turn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...errors import DesignError, shown
from ...plane.vec import Array
from .timeline import SLIP, band, spans
from .laws import breaks_of
from .optimise import Optimum
from .pieces import Piece, pieces_of, reach
from .segments import Dwell, OneSegment, Return, Rise, Segment
from .table_fit import TableFit

__all__ = ["Dwell", "FollowerMotion", "Program", "Return", "Rise", "Segment"]


@dataclass(frozen=True, eq=False)
class FollowerMotion:
    """The follower over cam angles: lift mm and its derivatives by angle, mm/rad, mm/rad2, mm/rad3.

    For a follower that swings, rad, rad/rad, rad/rad2, rad/rad3.
    """

    lift: Array
    velocity: Array
    acceleration: Array
    jerk: Array


@dataclass(frozen=True)
class Program:
    """Segments one after another from 0 to 360 deg, whose lift ends where it began and stays above 0.

    folder: where a table's file must lie, there or below, as for a recipe's; a script's, without one, may lie anywhere.
    """

    segments: Sequence[Segment]
    folder: str | Path | None = None

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """A recipe gives the list of segments itself; the folder comes with the context it is validated in."""
        from pydantic_core import core_schema

        return core_schema.with_info_after_validator_function(
            lambda segments, info: cls(segments, (info.context or {}).get("folder", ".")),
            handler.generate_schema(tuple[OneSegment, ...]),
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda program: [_plain(segment) for segment in program.segments]
            ),
        )

    def __post_init__(self) -> None:
        if not isinstance(self.segments, (tuple, list)):
            raise DesignError("segments", f"found {shown(self.segments)}", "give a list of segments, such as Dwell")
        if not isinstance(self.folder, (str, Path, type(None))):
            raise DesignError("folder", f"found {shown(self.folder)}", "give the path of a folder")
        self._resolved  # refuses what does not add up

    @cached_property
    def _resolved(self) -> _Resolved:
        return _Resolved(pieces_of(spans(self.segments, self.folder)))

    @property
    def oscillates(self) -> bool:
        """Whether lifts are angles of an arm, given in degrees and told in radians. False for dwells alone."""
        return self._resolved.oscillates

    @property
    def breaks(self) -> Array:
        """Cam angles, rad, from 0 to 2 pi, between which lift, velocity, acceleration and jerk are continuous."""
        return self._resolved.breaks

    @property
    def optima(self) -> dict[int, Optimum]:
        """Of each optimised segment, by its place in `segments`: peaks in mm/rad2 and mm/rad3 and the bound.

        For a follower that swings, rad/rad2 and rad/rad3.
        """
        pieces = self._resolved.pieces
        return {k: piece.optimum for k, piece in enumerate(pieces) if piece.optimum is not None}

    @property
    def tables(self) -> dict[int, TableFit]:
        """Of each table, by its place in `segments`: its rows in mm or deg, and how much they scatter."""
        return {k: piece.fit for k, piece in enumerate(self._resolved.pieces) if piece.fit is not None}

    @property
    def jumps(self) -> FollowerMotion:
        """How much each derivative jumps at `breaks[:-1]`, up positive; the first at 0 deg, where the turn closes.

        A jump in velocity is an infinite acceleration, as where a uniform motion meets a dwell. What
        is below 1e-9 of the largest value is rounding, and told as 0.
        """
        return FollowerMotion(*self._resolved.jumps())

    def motion(self, angle: ArrayLike) -> FollowerMotion:
        """The follower at cam angles of any shape, rad; at a joint, that of the segment that starts there."""
        return FollowerMotion(*self._resolved.motion(np.asarray(angle, dtype=float)))


class _Resolved:
    """A programme's segments as arrays: spans (n,), pieces between breaks (p,), distinct laws.

    starts, widths (n,): rad. scales (4, n): what a law's rows are multiplied by. span, low, high (p,):
    the span a piece lies in, and its x there.
    """

    def __init__(self, pieces: list[Piece]):
        self.pieces = pieces
        self.oscillates = any(piece.span.oscillates for piece in pieces)
        self._check_base()
        # Where one dwell follows another nothing changes: they are one.
        resting = [piece.law is None for piece in pieces]
        pieces = [piece for k, piece in enumerate(pieces) if not (k and resting[k] and resting[k - 1])]
        unit = np.radians(1) if self.oscillates else 1.0
        limits = np.radians([*(piece.span.start for piece in pieces), 360.0])
        self.starts, self.widths = limits[:-1], np.diff(limits)
        self.lifts = np.array([piece.span.lift for piece in pieces]) * unit
        rises = np.array([piece.scale for piece in pieces])
        self.scales = rises * unit * self.widths ** -np.arange(4.0)[:, None]
        self.laws = list({id(piece.law): piece.law for piece in pieces if piece.law}.values())
        number = {id(law): k for k, law in enumerate(self.laws)}
        # The last number is that of no law: rest.
        self.law_of = np.array([number.get(id(piece.law), len(self.laws)) for piece in pieces])
        inner = [np.array([0.0, 1.0]) if piece.law is None else breaks_of(piece.law) for piece in pieces]
        self.span = np.repeat(np.arange(len(pieces)), [len(x) - 1 for x in inner])
        self.low = np.concatenate([x[:-1] for x in inner])
        # At a break inside a segment the piece before ends just before it, whatever the angle's rounding says.
        ends = np.concatenate([x[1:] for x in inner])
        self.high = np.where(ends < 1, np.nextafter(ends, 0), 1.0)
        self.breaks = np.append(self.starts[self.span] + self.widths[self.span] * self.low, limits[-1])

    def motion(self, angle: Array) -> Array:
        """(4, ...) at angles in rad."""
        turned = np.where((angle >= 0) & (angle <= self.breaks[-1]), angle, np.mod(angle, 2 * np.pi))
        piece = np.clip(np.searchsorted(self.breaks, turned, side="right") - 1, 0, len(self.span) - 1)
        span = self.span[piece]
        x = (turned - self.starts[span]) / self.widths[span]
        return self.values(span, np.clip(x, self.low[piece], self.high[piece]))

    def values(self, span: Array, x: Array) -> Array:
        """(4, ...) at places x from 0 to 1 of spans."""
        out = np.zeros((4, *np.shape(x)))
        flat, spans, places = out.reshape(4, -1), np.ravel(span), np.ravel(x)
        # By law, not by segment: a programme of very many segments costs no more than a short one.
        laws = self.law_of[spans]
        order = np.argsort(laws, kind="stable")
        limits = np.searchsorted(laws[order], np.arange(len(self.laws) + 1))
        for law, start, end in zip(self.laws, limits[:-1], limits[1:]):
            if end > start:
                where = order[start:end]
                flat[:, where] = self.scales[:, spans[where]] * law(places[where])
        out[0] += self.lifts[span]
        return out

    def jumps(self) -> Array:
        """(4, p): values after each break less those before."""
        before, after = self.values(self.span, self.high), self.values(self.span, self.low)
        # Places between, none of them where a symmetric motion is 0.
        inside = [self.values(self.span, self.low + share * (self.high - self.low)) for share in (0.3, 0.6)]
        largest = np.abs([before, *inside, after]).max(axis=(0, 2))[:, None]
        change = after - np.roll(before, 1, axis=1)
        return np.where(np.abs(change) > 1e-9 * largest, change, 0.0)

    def _check_base(self) -> None:
        unit = "deg" if self.oscillates else "mm"
        seen = [(piece, *reach(piece)) for piece in self.pieces]
        highest = max(high for *_, high in seen)
        for piece, low, angle, _ in seen:
            # A curve near rows may dip as far as it may leave them.
            if low < -max(SLIP, DIP * highest, band(piece.span.segment)):
                raise DesignError(
                    piece.span.place,
                    f"the lift falls to {low:g} {unit} at {angle:g} deg, below the base circle",
                    "give other values there, or more lift and a smaller base_radius",
                )


def _plain(segment: Segment) -> dict[str, Any]:
    """A segment as a recipe gives it; an arm's lifts only where there is an arm."""
    given = asdict(segment)
    return {name: value for name, value in given.items() if value is not None or name not in ARM_LIFTS}


ARM_LIFTS = ("rise_deg", "end_lift_deg")
# A curve through given values, such as measured ones, may dip below the base circle by this share of the lift:
# less than a cutter follows. Less refuses values for their last decimal, more shows on the cam.
DIP = 1e-4
