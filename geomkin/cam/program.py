"""The motion programme of a cam: segments that fill one turn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..errors import DesignError
from ..plane.vec import Array
from ..sizes import FARTHEST, OneOfKinds, check_sizes, entry, quantity
from .laws import LAWS

# Angles, deg, and lifts, mm, that a person wrote to add up may miss by this much: less refuses thirds
# of a turn written with nine digits, more hides a real gap.
SLIP = 1e-7

LawName = Literal["cycloidal", "harmonic", "3-4-5"]


def _angle(meaning: str) -> float | None:
    return quantity(meaning, "deg", default=None, at_least=-360, at_most=360)


@dataclass(frozen=True)
class Dwell:
    """The follower rests. Give two of start, end and duration; the start may be left to the segment before."""

    kind: Literal["dwell"] = "dwell"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")


@dataclass(frozen=True)
class Rise:
    """The follower moves away, by `rise` or to `end_lift`; give one of the two."""

    law: LawName = entry("law of motion", example="cycloidal")
    rise: float | None = quantity(
        "how far it moves, positive outward", "mm", default=None, at_least=-FARTHEST, at_most=FARTHEST
    )
    end_lift: float | None = quantity(
        "lift above the base circle where it ends", "mm", default=None, at_least=-FARTHEST, at_most=FARTHEST
    )
    kind: Literal["rise"] = "rise"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")


@dataclass(frozen=True)
class Return:
    """The follower moves back to `end_lift`, 0 unless given."""

    law: LawName = entry("law of motion", example="cycloidal")
    end_lift: float = quantity(
        "lift above the base circle where it ends", "mm", default=0.0, at_least=-FARTHEST, at_most=FARTHEST
    )
    kind: Literal["return"] = "return"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")


Segment = Annotated[Dwell | Rise | Return, OneOfKinds()]


@dataclass(frozen=True, eq=False)
class FollowerMotion:
    """The follower over cam angles: lift mm and its derivatives by angle, mm/rad, mm/rad2, mm/rad3."""

    lift: Array
    velocity: Array
    acceleration: Array
    jerk: Array


@dataclass(frozen=True)
class Program:
    """Segments one after another from 0 to 360 deg, whose lift ends where it began and stays above 0."""

    segments: Sequence[Dwell | Rise | Return]

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """A recipe gives the list of segments itself."""
        from pydantic_core import core_schema

        return core_schema.no_info_after_validator_function(
            cls,
            handler.generate_schema(tuple[Segment, ...]),
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda program: [asdict(segment) for segment in program.segments]
            ),
        )

    def __post_init__(self) -> None:
        self._resolved  # refuses what does not add up

    @cached_property
    def _resolved(self) -> tuple[Array, Array, tuple[str | None, ...]]:
        """Segment limits in deg (n + 1,), lifts there (n + 1,) and the law of each, None for a dwell."""
        limits, lifts, laws = [0.0], [0.0], []
        for k, segment in enumerate(self.segments):
            place = f"program[{k}]"
            try:
                check_sizes(segment)
            except DesignError as error:
                raise DesignError(f"{place}.{error.field}", error.problem, error.remedy) from None
            limits.append(_end(segment, limits[-1], place))
            lifts.append(_end_lift(segment, lifts[-1], place))
            laws.append(None if isinstance(segment, Dwell) else segment.law)
        if abs(limits[-1] - 360) > SLIP:
            raise DesignError("program", f"the segments end at {limits[-1]:g} deg", "make the last one end at 360 deg")
        if abs(lifts[-1] - lifts[0]) > SLIP:
            raise DesignError(
                "program", f"the lift ends at {lifts[-1]:g} mm, not at 0", "add a return, or correct its end_lift"
            )
        limits[-1], lifts[-1] = 360.0, lifts[0]
        return np.array(limits), np.array(lifts), tuple(laws)

    @property
    def breaks(self) -> Array:
        """Cam angles of the segments' limits, rad, from 0 to 2 pi."""
        return np.radians(self._resolved[0])

    def motion(self, angle: ArrayLike) -> FollowerMotion:
        """The follower at cam angles of any shape, rad; at a joint, that of the segment that starts there."""
        angle = np.asarray(angle, dtype=float)
        breaks, (_, lifts, laws) = self.breaks, self._resolved
        turned = np.where((angle >= 0) & (angle <= breaks[-1]), angle, np.mod(angle, 2 * np.pi))
        which = np.clip(np.searchsorted(breaks, turned, side="right") - 1, 0, len(laws) - 1)
        span, rise = np.diff(breaks)[which], np.diff(lifts)[which]
        out = np.zeros((4, *angle.shape))
        # By law, not by segment: a programme of very many segments costs no more than a short one.
        named = np.array([law or "" for law in laws])[which]
        for law in {law for law in laws if law}:
            mask = named == law
            x = (turned[mask] - breaks[which[mask]]) / span[mask]
            out[:, mask] = rise[mask] * span[mask] ** -np.arange(4.0)[:, None] * LAWS[law](x)
        out[0] += lifts[which]
        return FollowerMotion(*out)


def _end(segment: Dwell | Rise | Return, before: float, place: str) -> float:
    start = before if segment.start_deg is None else segment.start_deg
    if abs(start - before) > SLIP:
        kind = "a gap" if start > before else "an overlap"
        raise DesignError(
            f"{place}.start_deg",
            f"found {start:g}, but the segment before ends at {before:g} deg: {kind}",
            "leave start_deg out, or add a dwell between them",
        )
    ends = [segment.end_deg, None if segment.duration_deg is None else before + segment.duration_deg]
    known = [e for e in ends if e is not None]
    if not known or (len(known) == 2 and abs(known[0] - known[1]) > SLIP):
        found = "neither" if not known else "two that disagree"
        raise DesignError(f"{place}.end_deg", f"of end_deg and duration_deg found {found}", "give one of them")
    if known[0] - before <= SLIP:
        raise DesignError(
            f"{place}.end_deg",
            f"the segment runs from {before:g} to {known[0]:g} deg",
            "give an end after its start",
        )
    return known[0]


def _end_lift(segment: Dwell | Rise | Return, before: float, place: str) -> float:
    if isinstance(segment, Dwell):
        return before
    if isinstance(segment, Rise):
        reached = None if segment.rise is None else before + segment.rise
        ways = [v for v in (segment.end_lift, reached) if v is not None]
        if len(ways) != 1:
            raise DesignError(
                f"{place}.rise", f"of rise and end_lift found {('neither', '', 'both')[len(ways)]}", "give one of them"
            )
        end = ways[0]
        if end <= before:
            raise DesignError(f"{place}.rise", f"it ends at {end:g} mm, not above its start", "use a return to go down")
        return end
    end = segment.end_lift
    if end >= before:
        raise DesignError(f"{place}.end_lift", f"found {end:g} mm, not below its start", "use a rise to go up")
    if end < 0:
        raise DesignError(f"{place}.end_lift", f"found {end:g} mm, below the base circle", "give 0 mm or more")
    return end
