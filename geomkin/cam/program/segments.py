"""The segments of a motion programme, as a recipe contains them.

Every segment starts at the end of the one before; its end is given by `end_deg` or `duration_deg`. Lifts are in mm for
a translating follower, in degrees, with `_deg` in the name, for an oscillating one. Derivatives are by the cam angle in
radians: mm/rad, mm/rad2, mm/rad3, and for an oscillating follower rad/rad, rad/rad2, rad/rad3. Pressure angle and
curvature use these, and multiplied by the speed in rad/s the first one is a velocity; by degrees a jerk would be
190000 times smaller.
"""

from __future__ import annotations

from typing import Any, Literal

from ...core.fields import FARTHEST, Rows, entry, quantity
from ...core.records import record
from .laws import Law, LawName

AnyLaw = LawName | Law


def _angle(meaning: str) -> Any:
    return quantity(meaning, "deg", default=None, at_least=-360, at_most=360)


def _lift(meaning: str, unit: str = "mm") -> Any:
    most = FARTHEST if unit == "mm" else 360
    return quantity(meaning, unit, default=None, at_least=-most, at_most=most)


def _derivative(meaning: str, unit: str) -> Any:
    return quantity(meaning, unit, default=None, at_least=-FARTHEST, at_most=FARTHEST)


@record
class Dwell:
    """A dwell: the follower rests.

    Parameters
    ----------
    start_deg, end_deg, duration_deg : float, optional
        Cam angles of start and end, and their difference, deg. Give the end or the duration; by default the segment
        starts at the end of the one before.

    See Also
    --------
    Rise, Return, Program

    Notes
    -----
    The term is that of Rothbart, Cams (1956).
    """

    kind: Literal["dwell"] = "dwell"
    start_deg: float | None = _angle("cam angle at the start")
    end_deg: float | None = _angle("cam angle at the end")
    duration_deg: float | None = _angle("range of cam angles")


@record
class Rise:
    """A rise: the follower moves away from the cam's axis.

    Parameters
    ----------
    law : str or callable
        Law of motion: "uniform", "parabolic", "harmonic", "cycloidal", "modified-trapezoid", "modified-sine", "3-4-5"
        or "4-5-6-7". A callable of x (...) from 0 to 1 returns f, f', f'', f''' with shape (4, ...), f from 0 to 1;
        its attribute `breaks` lists the x of jumps of derivatives, with 0 and 1.
    rise, end_lift : float, optional
        Displacement, positive outwards, or lift at the end, mm. Give one of the two.
    rise_deg, end_lift_deg : float, optional
        The same for an arm, deg.
    start_deg, end_deg, duration_deg : float, optional
        Cam angles of start and end, and their difference, deg. Give the end or the duration; by default the segment
        starts at the end of the one before.

    See Also
    --------
    Return, Dwell, Program

    Notes
    -----
    The named laws are those of VDI 2143 Blatt 1 (1980) and Norton, Cam Design and Manufacturing Handbook.

    Examples
    --------
    >>> gk.Rise("3-4-5", rise=20, end_deg=150).rise
    20
    """

    law: AnyLaw = entry("law of motion", example="cycloidal")
    rise: float | None = _lift("displacement, positive outwards")
    end_lift: float | None = _lift("lift above the base circle at the end")
    kind: Literal["rise"] = "rise"
    start_deg: float | None = _angle("cam angle at the start")
    end_deg: float | None = _angle("cam angle at the end")
    duration_deg: float | None = _angle("range of cam angles")
    rise_deg: float | None = _lift("displacement of an arm, positive outwards", "deg")
    end_lift_deg: float | None = _lift("lift of an arm at the end", "deg")


@record
class Return:
    """A return: the follower moves back towards the cam's axis.

    Parameters
    ----------
    law : str or callable
        Law of motion, as for `Rise`.
    fall, end_lift : float, optional
        Displacement, positive inwards, or lift at the end, mm. Give one of the two; by default the end is at 0.
    fall_deg, end_lift_deg : float, optional
        The same for an arm, deg.
    start_deg, end_deg, duration_deg : float, optional
        Cam angles of start and end, and their difference, deg. Give the end or the duration; by default the segment
        starts at the end of the one before.

    See Also
    --------
    Rise, Dwell, Program

    Notes
    -----
    The named laws are those of VDI 2143 Blatt 1 (1980) and Norton, Cam Design and Manufacturing Handbook.
    """

    law: AnyLaw = entry("law of motion", example="cycloidal")
    end_lift: float = quantity(
        "lift above the base circle at the end", "mm", default=0.0, at_least=-FARTHEST, at_most=FARTHEST
    )
    kind: Literal["return"] = "return"
    start_deg: float | None = _angle("cam angle at the start")
    end_deg: float | None = _angle("cam angle at the end")
    duration_deg: float | None = _angle("range of cam angles")
    end_lift_deg: float | None = _lift("lift of an arm at the end", "deg")
    fall: float | None = _lift("displacement, positive inwards")
    fall_deg: float | None = _lift("displacement of an arm, positive inwards", "deg")


@record
class LiftPolynomial:
    """The polynomial of least degree that meets given conditions.

    Parameters
    ----------
    rise, end_lift : float, optional
        Displacement, positive outwards, or lift at the end, mm. Give one of the two.
    rise_deg, end_lift_deg : float, optional
        The same for an arm, deg.
    start_velocity_per_rad, end_velocity_per_rad : float, optional
        Velocity at start and end, mm/rad; rad/rad for an arm.
    start_acceleration_per_rad2, end_acceleration_per_rad2 : float, optional
        Acceleration at start and end, mm/rad2; rad/rad2 for an arm.
    start_jerk_per_rad3, end_jerk_per_rad3 : float, optional
        Jerk at start and end, mm/rad3; rad/rad3 for an arm.
    through : sequence of (float, float), optional
        Intermediate values as (cam angle in deg, lift in mm, or in deg for an arm).
    start_deg, end_deg, duration_deg : float, optional
        Cam angles of start and end, and their difference, deg. Give the end or the duration; by default the segment
        starts at the end of the one before.

    Notes
    -----
    The lift at the start is that of the segment before. Each condition raises the degree by one. Polynomials from
    boundary conditions: Norton, Cam Design and Manufacturing Handbook.
    """

    rise: float | None = _lift("displacement, positive outwards")
    end_lift: float | None = _lift("lift above the base circle at the end")
    rise_deg: float | None = _lift("displacement of an arm, positive outwards", "deg")
    end_lift_deg: float | None = _lift("lift of an arm at the end", "deg")
    start_velocity_per_rad: float | None = _derivative("velocity at the start; rad/rad for an arm", "mm/rad")
    start_acceleration_per_rad2: float | None = _derivative("acceleration there; rad/rad2 for an arm", "mm/rad2")
    start_jerk_per_rad3: float | None = _derivative("jerk there; rad/rad3 for an arm", "mm/rad3")
    end_velocity_per_rad: float | None = _derivative("velocity at the end; rad/rad for an arm", "mm/rad")
    end_acceleration_per_rad2: float | None = _derivative("acceleration there; rad/rad2 for an arm", "mm/rad2")
    end_jerk_per_rad3: float | None = _derivative("jerk there; rad/rad3 for an arm", "mm/rad3")
    through: Rows = entry(
        "intermediate values, as [cam angle in deg, lift in mm, or deg for an arm]", default=(), units=("deg", "mm")
    )
    kind: Literal["polynomial"] = "polynomial"
    start_deg: float | None = _angle("cam angle at the start")
    end_deg: float | None = _angle("cam angle at the end")
    duration_deg: float | None = _angle("range of cam angles")


@record
class LiftSpline:
    """The smoothest curve through given values, a quintic spline with continuous jerk.

    Parameters
    ----------
    points : sequence of (float, float), optional
        Values as (cam angle in deg, lift in mm), from the start of the segment to its end.
    points_deg : sequence of (float, float), optional
        The same for an arm, with the lift in deg.

    Notes
    -----
    At both ends velocity and acceleration match those of the neighbours, so only the jerk jumps. A spline that is the
    only segment is periodic; as the first segment it defines the lift at angle 0. Natural splines of odd degree as the
    smoothest curves: de Boor, A Practical Guide to Splines (1978); the equations are derived here.
    """

    points: Rows | None = entry(
        "values, as [cam angle in deg, lift in mm], from start to end", default=None, units=("deg", "mm")
    )
    points_deg: Rows | None = entry("values of an arm, as [cam angle in deg, lift in deg]", default=None)
    kind: Literal["spline"] = "spline"


@record
class LiftTable:
    """Many lifts, measured or from another program, in the recipe or in a CSV file.

    Parameters
    ----------
    decimals : int, optional
        Decimal places to which the lifts are rounded; the band is then 3/4 of the last one. From 10 on the curve passes
        through all rows.
    rows : sequence of (float, float), optional
        Values as (cam angle in deg, lift in mm), from the start of the segment to its end.
    rows_deg : sequence of (float, float), optional
        The same for an arm, with the lift in deg.
    file : str, optional
        CSV file whose first line names the columns `cam_angle_deg` and `lift_mm`, or `lift_deg` for an arm; other
        columns are ignored. A relative name refers to the folder of the recipe.
    within : float, optional
        Largest distance of the curve from every row, mm; deg for an arm. Give either this or `decimals`.

    Notes
    -----
    The second derivative of rounded or measured values is mostly noise: a curve through all of 360 rows of a 20 mm rise
    in 120 deg, rounded to 0.001 mm, misses the motion by 3 times its peak acceleration. So the curve is the smoothest
    quintic spline, with the least integral of squared jerk, that stays within the band. The same rows then give the
    acceleration to 0.2 % of the peak. Jumps are rounded off: if rows one degree apart contain the joint of a dwell and
    a cycloidal rise, the acceleration there is exact to 5 % and the jerk, which jumps, to half its jump. So give dwells
    as dwells, or better the law itself. Below the base circle the curve goes by no more than the band. The ends are
    those of `LiftSpline`. A table that is the only segment may start at any angle, such as -180 deg, if it has a row at
    0 deg; if its rows are in equal steps, the last one may be omitted.

    Smoothing splines after Reinsch, Numer. Math. 10 (1967) 177-183, with a bound for each row; derived here.
    """

    decimals: int | None = quantity(
        "decimal places to which the lifts are rounded", default=None, at_least=0, at_most=15, whole=True, example=3
    )
    rows: Rows | None = entry(
        "values, as [cam angle in deg, lift in mm], from start to end", default=None, units=("deg", "mm")
    )
    rows_deg: Rows | None = entry("values of an arm, as [cam angle in deg, lift in deg]", default=None)
    file: str | None = entry("CSV file with columns cam_angle_deg and lift_mm or lift_deg", default=None)
    within: float | None = quantity(
        "largest distance of the curve from every row; deg for an arm", "mm", default=None, above=0, at_most=FARTHEST
    )
    kind: Literal["table"] = "table"


@record(checked=True)
class OptimisedPolynomial:
    """The polynomial of a degree with the least peak acceleration that matches its neighbours.

    Parameters
    ----------
    degree : int, optional
        Degree, 5 to 15.
    rise, end_lift : float, optional
        Displacement, positive outwards, or lift at the end, mm. Give one of the two.
    rise_deg, end_lift_deg : float, optional
        The same for an arm, deg.
    match_jerk : bool, optional
        Whether to match the neighbours' jerk too; needs degree 7 or more.
    jerk_limit : float, optional
        Largest jerk as a multiple of rise / angle^3; cycloidal has 39.5, 3-4-5 has 60.
    start_deg, end_deg, duration_deg : float, optional
        Cam angles of start and end, and their difference, deg. Give the end or the duration; by default the segment
        starts at the end of the one before.

    Notes
    -----
    Lift, velocity and acceleration match those of the neighbours. Next to a segment that matches its neighbours too,
    such as a spline, both come to rest. Between two dwells degree 5 is 3-4-5, and even degrees have no benefit.
    Derived here, as a linear programme.
    """

    degree: int = quantity("degree of the polynomial", default=9, at_least=5, at_most=15, whole=True)
    rise: float | None = _lift("displacement, positive outwards")
    end_lift: float | None = _lift("lift above the base circle at the end")
    rise_deg: float | None = _lift("displacement of an arm, positive outwards", "deg")
    end_lift_deg: float | None = _lift("lift of an arm at the end", "deg")
    match_jerk: bool = entry("whether to match the neighbours' jerk too; needs degree 7 or more", default=False)
    jerk_limit: float | None = quantity(
        "largest jerk, as a multiple of rise / angle^3; cycloidal has 39.5, 3-4-5 has 60",
        default=None, above=0, at_most=1e6,
    )  # fmt: skip
    kind: Literal["optimised-polynomial"] = "optimised-polynomial"
    start_deg: float | None = _angle("cam angle at the start")
    end_deg: float | None = _angle("cam angle at the end")
    duration_deg: float | None = _angle("range of cam angles")


@record
class OptimisedSpline:
    """The motion with piecewise linear acceleration and the least peak acceleration that matches its neighbours.

    Parameters
    ----------
    intervals : int, optional
        Number of equal intervals of the acceleration, 3 to 400.
    rise, end_lift : float, optional
        Displacement, positive outwards, or lift at the end, mm. Give one of the two.
    rise_deg, end_lift_deg : float, optional
        The same for an arm, deg.
    jerk_limit : float, optional
        Largest jerk as a multiple of rise / angle^3; cycloidal has 39.5, 3-4-5 has 60.
    start_deg, end_deg, duration_deg : float, optional
        Cam angles of start and end, and their difference, deg. Give the end or the duration; by default the segment
        starts at the end of the one before.

    Notes
    -----
    Lift, velocity and acceleration match those of the neighbours. With many intervals the peak approaches the least of
    all motions: 4 rise / angle^2 between two dwells, and with a jerk of at most J rise / angle^3 that times
    J/16 (1 - sqrt(1 - 32/J)), J at least 32. Derived here, as a linear programme.
    """

    intervals: int = quantity("intervals of the acceleration", default=20, at_least=3, at_most=400, whole=True)
    rise: float | None = _lift("displacement, positive outwards")
    end_lift: float | None = _lift("lift above the base circle at the end")
    rise_deg: float | None = _lift("displacement of an arm, positive outwards", "deg")
    end_lift_deg: float | None = _lift("lift of an arm at the end", "deg")
    jerk_limit: float | None = quantity(
        "largest jerk, as a multiple of rise / angle^3; cycloidal has 39.5, 3-4-5 has 60",
        default=None, above=0, at_most=1e6,
    )  # fmt: skip
    kind: Literal["optimised-spline"] = "optimised-spline"
    start_deg: float | None = _angle("cam angle at the start")
    end_deg: float | None = _angle("cam angle at the end")
    duration_deg: float | None = _angle("range of cam angles")


# Segments that move to a lift, segments with start and end as angles, and segments with their own points.
Moving = Rise | LiftPolynomial | OptimisedPolynomial | OptimisedSpline
Timed = Dwell | Return | Moving
Pointed = LiftSpline | LiftTable
Segment = Timed | Pointed
