"""The disk cam and its curves, exact from the motion programme."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError, shown
from ..core.fields import FARTHEST, entry, moving_picture, quantity
from ..core.records import record
from ..plane.curve import AbstractCurve
from ..plane.vec import Array, Complex, Pose, Real
from .followers.follower import AbstractFollower, Contact, Follower
from .followers.roller import TranslatingRoller
from .program.program import Program
from .program.segments import Dwell, Return, Rise

# Smooth stretches of a programme. With more, the search for undercut and the least base circle exceeds five seconds.
MOST_STRETCHES = 500

Direction = Literal["counterclockwise", "clockwise"]


@record(checked=True)
class Cam:
    """A disk cam about the origin, drawn at cam angle 0, and the follower that rides on it.

    Parameters
    ----------
    follower : AbstractFollower
        The follower, such as `TranslatingRoller`, `TranslatingFlat`, `OscillatingRoller` or `OscillatingFlat`.
    program : Program
        The follower's lift over one turn: mm for a translating follower, degrees for an oscillating one.
    base_radius : float
        Radius of the cam where the lift is 0, mm.
    direction : {"counterclockwise", "clockwise"}, optional
        Direction in which the cam turns.

    Raises
    ------
    DesignError
        If the follower cannot ride on such a cam, if the units of the lifts do not suit the follower, or if the
        programme has more than 500 smooth stretches.

    See Also
    --------
    Program, TranslatingRoller, TranslatingFlat, OscillatingRoller, OscillatingFlat, pressure_angle,
    undercut

    Notes
    -----
    The cam angle, rad, is the rotation of the cam since the drawn position; it rises with time in either direction.
    Points are complex numbers in mm. The terms base circle, prime circle and pitch curve are those of Rothbart,
    Cams (1956); the formulas are derived here.

    Examples
    --------
    >>> rise, back = gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360)
    >>> cam = gk.Cam(gk.TranslatingRoller(10), gk.Program((rise, back)), base_radius=40)
    >>> cam.prime_radius
    50
    """

    follower: Follower = entry("follower that rides on the cam", example=TranslatingRoller(10))
    program: Program = entry(
        "segments that fill one turn",
        example=Program((Dwell(end_deg=120), Rise("3-4-5", rise=20, end_deg=240), Return("cycloidal", end_deg=360))),
    )
    base_radius: float = quantity("radius of the cam where the lift is 0", "mm", above=0, at_most=FARTHEST, example=40)
    direction: Direction = entry("direction in which the cam turns", default="counterclockwise")
    can_be_scaled: ClassVar[bool] = True

    def __post_init__(self) -> None:
        check_lifts(self.follower, self.program)
        stretches = len(self.program.breaks) - 1
        if stretches > MOST_STRETCHES:
            problem = f"found {stretches:,} smooth stretches between joints; adjacent dwells count as one"
            remedy = f"give at most {MOST_STRETCHES}, or replace many segments by a table"
            raise DesignError("program", problem, remedy, "too-much-work")
        self.follower.check(self.program, self.base_radius, self.sense)

    _repr_html_ = moving_picture

    @property
    def prime_radius(self) -> float:
        """Radius of the prime circle, mm: the smallest distance from the cam axis to the roller's centre.

        For a flat face it equals the base radius.
        """
        return self.base_radius + self.follower.roller_radius

    @property
    def sense(self) -> int:
        """+1 if the cam turns counterclockwise, -1 if clockwise."""
        return turning_sense(self.direction)

    @property
    def pitch_curve(self) -> AbstractCurve:
        """Path of the roller's centre on the cam; the parameter is the cam angle, 0 to 2 pi rad.

        Raises
        ------
        DesignError
            If the follower has a flat face.
        """
        knife = self.follower.knife_edge
        if knife is None:
            problem = "a cam with a flat-faced follower has no pitch curve"
            raise DesignError("follower", problem, "use the profile instead", "conflict")
        # The roller's centre is a knife edge on the prime circle.
        return Profile(knife, self.program, self.prime_radius, self.sense)

    @property
    def profile(self) -> AbstractCurve:
        """Curve of the contact points on the cam; the parameter is the cam angle, 0 to 2 pi rad.

        The curve is exact and untrimmed: it contains loops if the follower undercuts the cam, and it jumps where the
        programme's velocity jumps. `undercut` returns the trimmed outline.
        """
        return Profile(self.follower, self.program, self.base_radius, self.sense)

    def contact(self, angle: ArrayLike) -> Contact:
        """Contact of cam and follower at given cam angles.

        Parameters
        ----------
        angle : array_like
            Cam angles, rad, any shape. At a joint of two segments the segment that starts there counts.

        Returns
        -------
        Contact
            In the ground's frame. A contact point z lies on the cam at z exp(-i sense angle).
        """
        motion = self.program.motion(np.asarray(angle, dtype=float))
        return self.follower.contact(motion, self.base_radius, self.sense)

    @checked
    def sensitivity(self, of: Literal["profile", "pressure_angle"], by: str, angle: ArrayLike) -> Array:
        """Derivative of the profile or of the pressure angle by a size of the cam, exact to rounding.

        Parameters
        ----------
        of : {"profile", "pressure_angle"}
            The quantity: a point of the profile, complex, mm, or the signed pressure angle, rad.
        by : str
            The size: `base_radius`, or one of the follower's, such as `follower.roller_radius`, `follower.offset`,
            `follower.pivot_distance`, `follower.arm_length`, `follower.face_offset` or `follower.tilt_deg`.
        angle : array_like
            Cam angles, rad, any shape. They and the programme do not change.

        Returns
        -------
        ndarray
            The quantity's unit per mm, or per rad of an angle, shape of `angle`.

        Raises
        ------
        DesignError
            If the cam has no such size; lists the names.

        Notes
        -----
        Derived here from the formulas of the contact.

        Examples
        --------
        >>> program = gk.Program((gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360)))
        >>> cam = gk.Cam(gk.TranslatingRoller(10), program, base_radius=40)
        >>> cam.sensitivity("pressure_angle", by="base_radius", angle=[0.0, 1.0]).round(5)
        array([ 0.     , -0.00391])
        """
        t = np.asarray(angle, dtype=float)
        rates = self.follower.contact_rates(self.program.motion(t), self.base_radius, self.sense)
        names = {name if name == "base_radius" else f"follower.{name}": name for name in rates}
        if by not in names:
            known = f"give one of {', '.join(names)}" if names else "this follower has no derivatives"
            raise DesignError("by", f"found {shown(by)}, which is the name of no size", known, "unknown-key")
        point, pressure_angle = rates[names[by]]
        return np.exp(-1j * self.sense * t) * point if of == "profile" else pressure_angle

    def follower_pose(self, angle: ArrayLike) -> Pose:
        """Pose of the follower at given cam angles.

        Parameters
        ----------
        angle : array_like
            Cam angles, rad, any shape.

        Returns
        -------
        Pose
            The origin is the roller's centre, the point where a translating face crosses the y axis, or the pivot of
            an arm. The x axis is parallel to the ground's, or runs along the face or the arm.
        """
        return self.follower.pose(self.program.motion(np.asarray(angle, dtype=float)).lift, self.base_radius)


@record(eq=False)
class Profile(AbstractCurve):
    """Contact points of a follower in the cam's frame: E z with E = exp(-i sense t) from ground to cam."""

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
        return -1j * self.sense * np.exp(-1j * self.sense * t) * contact.normal * contact.profile_speed

    def curvature(self, t: ArrayLike) -> Real:
        contact = self._contact(np.asarray(t, dtype=float))
        with np.errstate(divide="ignore"):
            return contact.normal_rate / np.abs(contact.profile_speed)

    def _contact(self, t: Real) -> Contact:
        return self.follower.contact(self.program.motion(t), self.base_radius, self.sense)

    @property
    def breaks(self) -> Real:
        return self.program.breaks

    closed = True


def turning_sense(direction: Direction) -> int:
    """+1 for counterclockwise, -1 for clockwise."""
    return 1 if direction == "counterclockwise" else -1


def check_lifts(follower: AbstractFollower, program: Program) -> None:
    """Raise DesignError if the units of the programme's lifts do not suit the follower."""
    if program.oscillates == follower.oscillates:
        return
    kind = follower.kind.replace("-", " ")
    raise DesignError(
        "program",
        f"its lifts are in {'mm' if follower.oscillates else 'degrees'}, but the {kind} follower "
        f"{'swings about a pivot' if follower.oscillates else 'moves along a line'}",
        f"give the lifts in {'degrees' if follower.oscillates else 'mm'}, or a follower that "
        f"{'moves along a line' if follower.oscillates else 'swings about a pivot'}",
        "conflict",
    )
