"""The disk cam and its curves, exact from the motion programme."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, quantity
from ..core.records import record
from ..core.reprs import moving
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Pose, Real
from .followers.follower import AbstractFollower, Contact, Follower
from .followers.roller import TranslatingRoller
from .program.program import Program
from .program.segments import Dwell, Return, Rise

# Smooth stretches of a programme: of more, a search for undercut and least base circle takes over five seconds.
MOST_STRETCHES = 500

Direction = Literal["counterclockwise", "clockwise"]


@record(checked=True)
class Cam:
    """A disk cam about the origin, drawn at cam angle 0, and the follower that rides on it.

    Its cam angle is how far it has turned, rad, rising with time whichever its direction; points are complex, mm.
    DesignError where the follower cannot ride on such a cam, or the programme's lifts are of the wrong sort for it.

    Source: the words are those of Rothbart, Cams (1956): base circle, prime circle, pitch curve; the formulas are
    derived here.
    """

    follower: Follower = entry("what rides on the cam", example=TranslatingRoller(10))
    program: Program = entry(
        "segments that fill one turn",
        example=Program((Dwell(end_deg=120), Rise("3-4-5", rise=20, end_deg=240), Return("cycloidal", end_deg=360))),
    )
    base_radius: float = quantity("radius of the cam where the lift is 0", "mm", above=0, at_most=FARTHEST, example=40)
    direction: Direction = entry("way the cam turns", default="counterclockwise")
    can_be_scaled: ClassVar[bool] = True

    def __post_init__(self) -> None:
        check_lifts(self.follower, self.program)
        stretches = len(self.program.breaks) - 1
        if stretches > MOST_STRETCHES:
            raise DesignError(
                "program",
                f"found {stretches:,} stretches between joints, dwells in a row taken as one",
                f"give at most {MOST_STRETCHES}, or a table in place of many segments",
            )
        self.follower.check(self.program, self.base_radius, self.sense)

    _repr_html_ = moving

    @property
    def prime_radius(self) -> float:
        """Least distance of a roller's centre from the cam axis, mm; of a flat face, the base radius."""
        return self.base_radius + self.follower.rounding

    @property
    def sense(self) -> int:
        """+1 where the cam turns counterclockwise, -1 clockwise."""
        return turning_sense(self.direction)

    @property
    def pitch_curve(self) -> AbstractCurve:
        """Path of the roller's centre on the cam; t is the cam angle, rad, 0 to 2 pi. A flat face has none."""
        knife = self.follower.knife_edge
        if knife is None:
            raise DesignError("follower", "a flat face has no roller, so its cam no pitch curve", "use the profile")
        # The roller's centre is a knife edge on the prime circle.
        return Profile(knife, self.program, self.prime_radius, self.sense)

    @property
    def profile(self) -> AbstractCurve:
        """What the follower touches, on the cam; t is the cam angle, rad, 0 to 2 pi.

        Exact, and untrimmed: loops are included where the follower undercuts, and where the programme's
        velocity jumps so does the point of contact. `undercut` gives the outline of the cam that is left.
        """
        return Profile(self.follower, self.program, self.base_radius, self.sense)

    def contact(self, angle: ArrayLike) -> Contact:
        """Cam and follower where they touch, at cam angles in rad; a point z of it lies on the cam at z exp(-i sgn t).

        At a joint, that of the segment that starts there.
        """
        motion = self.program.motion(np.asarray(angle, dtype=float))
        return self.follower.contact(motion, self.base_radius, self.sense)

    def follower_pose(self, angle: ArrayLike) -> Pose:
        """Where the follower stands at cam angles in rad.

        Its origin is the roller's centre, the place where a translating face crosses the y axis, or an arm's
        pivot; its x axis lies as the ground's, or runs along the face or the arm.
        """
        return self.follower.place(self.program.motion(np.asarray(angle, dtype=float)).lift, self.base_radius)


@record(eq=False)
class Profile(AbstractCurve):
    """Where a follower touches its cam, seen from the cam: E z with E = exp(-i sgn t) from ground to cam."""

    follower: AbstractFollower
    program: Program
    base_radius: float
    sense: int

    def point(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        return np.exp(-1j * self.sense * t) * self._contact(t).point

    def velocity(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        contact = self._contact(t)
        return -1j * self.sense * np.exp(-1j * self.sense * t) * contact.normal * contact.advance

    def curvature(self, t: ArrayLike) -> Real:
        contact = self._contact(np.asarray(t, dtype=float))
        with np.errstate(divide="ignore"):
            return contact.turn / np.abs(contact.advance)

    def _contact(self, t: Real) -> Contact:
        return self.follower.contact(self.program.motion(t), self.base_radius, self.sense)

    @property
    def breaks(self) -> Real:
        return self.program.breaks

    @property
    def closed(self) -> bool:
        return True


def turning_sense(direction: Direction) -> int:
    """+1 for counterclockwise, -1 for clockwise."""
    return 1 if direction == "counterclockwise" else -1


def check_lifts(follower: AbstractFollower, program: Program) -> None:
    """Raises DesignError where the programme's lifts are of the wrong sort for the follower."""
    if program.oscillates == follower.oscillates:
        return
    kind = follower.kind.replace("-", " ")
    raise DesignError(
        "program",
        f"its lifts are in {'mm' if follower.oscillates else 'degrees'}, but the follower is of the {kind} sort, "
        f"which {'swings about a pivot' if follower.oscillates else 'moves along a line'}",
        f"give the lifts in {'degrees' if follower.oscillates else 'mm'}, or a follower of the other sort",
    )
