"""The segments a motion programme is made of, as a recipe writes them.

Every segment starts where the one before ends; its end is given by `end_deg` or `duration_deg`. Lifts
are in mm for a follower that slides, in degrees, with `_deg` in the name, for one that swings.
Derivatives are by the cam's angle in radians: mm/rad, mm/rad2, mm/rad3, and for a swinging follower
rad/rad, rad/rad2, rad/rad3. That is what a pressure angle and a curvature are made of, and times the
speed in rad/s it is a velocity; by the degree a jerk would be 190000 times smaller.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from ...core.fields import FARTHEST, OneOfKinds, Rows, entry, quantity
from ...core.records import record
from .laws import Law, LawName, NamedLaw

AnyLaw = Annotated[LawName | Law, NamedLaw()]
LAW_MEANING = f"law of motion: {', '.join(get_args(LawName))}"


def _angle(meaning: str) -> Any:
    return quantity(meaning, "deg", default=None, at_least=-360, at_most=360)


def _lift(meaning: str, unit: str = "mm") -> Any:
    most = FARTHEST if unit == "mm" else 360
    return quantity(meaning, unit, default=None, at_least=-most, at_most=most)


def _derivative(meaning: str, unit: str) -> Any:
    return quantity(meaning, unit, default=None, at_least=-FARTHEST, at_most=FARTHEST)


@record
class Dwell:
    """The follower rests. Give two of start, end and duration; the start may be left to the segment before.

    Source: the word is that of Rothbart, Cams (1956).
    """

    kind: Literal["dwell"] = "dwell"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")


@record
class Rise:
    """The follower moves away, by `rise` or to `end_lift`; give one of the two.

    In the library, `law` may be a callable: of x (...) from 0 to 1, it returns f, f', f'', f''' as
    (4, ...), with f from 0 to 1. Where a derivative jumps inside, its attribute `breaks` says so, x from 0 to 1.

    Source of the named laws: VDI 2143 Blatt 1 (1980); Norton, Cam Design and Manufacturing Handbook.
    """

    law: AnyLaw = entry(LAW_MEANING, example="cycloidal")
    rise: float | None = _lift("how far it moves, positive outward")
    end_lift: float | None = _lift("lift above the base circle where it ends")
    kind: Literal["rise"] = "rise"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")
    rise_deg: float | None = _lift("how far an arm swings, positive outward", "deg")
    end_lift_deg: float | None = _lift("an arm's lift where it ends", "deg")


@record
class Return:
    """The follower moves back to `end_lift`, 0 unless given. `law` as for a rise.

    Source of the named laws: VDI 2143 Blatt 1 (1980); Norton, Cam Design and Manufacturing Handbook.
    """

    law: AnyLaw = entry(LAW_MEANING, example="cycloidal")
    end_lift: float = quantity(
        "lift above the base circle where it ends", "mm", default=0.0, at_least=-FARTHEST, at_most=FARTHEST
    )
    kind: Literal["return"] = "return"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")
    end_lift_deg: float | None = _lift("an arm's lift where it ends", "deg")


@record
class LiftPolynomial:
    """The polynomial of least degree that meets the conditions given, and no others.

    The lift at the start is that of the segment before; the lift at the end is given, and any of the
    derivatives at either end. Values between raise the degree by one each.

    Source: polynomials from boundary conditions, Norton, Cam Design and Manufacturing Handbook.
    """

    rise: float | None = _lift("how far it moves, positive outward")
    end_lift: float | None = _lift("lift above the base circle where it ends")
    rise_deg: float | None = _lift("how far an arm swings, positive outward", "deg")
    end_lift_deg: float | None = _lift("an arm's lift where it ends", "deg")
    start_velocity_per_rad: float | None = _derivative("velocity where it starts; rad/rad for an arm", "mm/rad")
    start_acceleration_per_rad2: float | None = _derivative("acceleration there; rad/rad2 for an arm", "mm/rad2")
    start_jerk_per_rad3: float | None = _derivative("jerk there; rad/rad3 for an arm", "mm/rad3")
    end_velocity_per_rad: float | None = _derivative("velocity where it ends; rad/rad for an arm", "mm/rad")
    end_acceleration_per_rad2: float | None = _derivative("acceleration there; rad/rad2 for an arm", "mm/rad2")
    end_jerk_per_rad3: float | None = _derivative("jerk there; rad/rad3 for an arm", "mm/rad3")
    through: Rows = entry(
        "values between, as [cam angle in deg, lift in mm, or deg for an arm]", default=(), units=("deg", "mm")
    )
    kind: Literal["polynomial"] = "polynomial"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")


@record
class LiftSpline:
    """The smoothest curve through given values, from the first to the last: a quintic spline, without jumps in jerk.

    Its ends take slope and curvature from the neighbours, so that nothing jumps there but the jerk.
    Alone in a programme it closes on itself. First in a programme it sets the lift at angle 0.

    Source: natural splines of odd degree as the smoothest curves, de Boor, A Practical Guide to Splines (1978); the
    equations are derived here.
    """

    points: Rows | None = entry(
        "values, as [cam angle in deg, lift in mm], from its start to its end", default=None, units=("deg", "mm")
    )
    points_deg: Rows | None = entry("values of an arm, as [cam angle in deg, lift in deg]", default=None)
    kind: Literal["spline"] = "spline"


@record
class LiftTable:
    """Many values from measurement or another program, in the recipe or in a CSV file.

    Two derivatives of rounded or measured values are mostly rounding and noise: a curve through all of 360 rows of
    a 20 mm rise in 120 deg, rounded to 0.001 mm, misses the motion by 3 times its peak acceleration. So the curve
    is the smoothest that leaves no row by more than `within`: of all quintic splines the one with the least integral
    of squared jerk. Rows rounded to some decimals need no `within`: it is 3/4 of the last of the `decimals`. The same
    rows then give the acceleration to 0.2 % of the peak. What jumps is rounded off: where rows a degree apart
    run on from a dwell into a cycloidal rise, the acceleration is good to 5 % and the jerk, which jumps, to half its
    jump. So give dwells as dwells and tables for what is between, or better the law itself. With ten decimals or
    more the curve goes through the rows.

    Ends as for a spline. Alone in a programme it closes on itself, and rows in equal steps may leave out
    that at 360 deg. The file is CSV with a first line that names the columns `cam_angle_deg` and `lift_mm`, or
    `lift_deg` for an arm; others are ignored. A relative name is looked for beside the recipe.

    Source: smoothing splines after Reinsch, Numer. Math. 10 (1967) 177-183, with a bound for each row; derived here.
    """

    decimals: int | None = quantity(
        "decimal places to which the lifts are rounded",
        default=None,
        at_least=0,
        at_most=15,
        whole=True,
        example=3,
    )
    rows: Rows | None = entry(
        "values, as [cam angle in deg, lift in mm], from its start to its end", default=None, units=("deg", "mm")
    )
    rows_deg: Rows | None = entry("values of an arm, as [cam angle in deg, lift in deg]", default=None)
    file: str | None = entry("CSV file with columns cam_angle_deg and lift_mm or lift_deg", default=None)
    within: float | None = quantity(
        "how far the curve may stay from every row, as the rows are measured; deg for an arm",
        "mm",
        default=None,
        above=0,
        at_most=FARTHEST,
    )
    kind: Literal["table"] = "table"


@record(checked=True)
class OptimisedPolynomial:
    """Of all polynomials of a degree that meet the neighbours' lift, slope and curvature, the one of least
    peak acceleration.

    Where the neighbour meets its own neighbours too, as a spline does, both come to rest. Between two
    rests 3-4-5 is degree 5, and even degrees gain nothing.

    Source: derived here, as a linear programme.
    """

    degree: int = quantity("degree of the polynomial", default=9, at_least=5, at_most=15, whole=True)
    rise: float | None = _lift("how far it moves, positive outward")
    end_lift: float | None = _lift("lift above the base circle where it ends")
    rise_deg: float | None = _lift("how far an arm swings, positive outward", "deg")
    end_lift_deg: float | None = _lift("an arm's lift where it ends", "deg")
    match_jerk: bool = entry("whether to meet the neighbours' jerk too; takes degree 7 at least", default=False)
    jerk_limit: float | None = quantity(
        "largest jerk, as a multiple of rise / angle^3; cycloidal has 39.5, 3-4-5 has 60",
        default=None,
        above=0,
        at_most=1e6,
    )
    kind: Literal["optimised-polynomial"] = "optimised-polynomial"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")


@record
class OptimisedSpline:
    """Of all motions with an acceleration straight over each of equal intervals that meet the neighbours' lift,
    slope and curvature, the one of least peak acceleration.

    Many intervals come near the least of all motions: 4 rise / angle^2 between two rests, and with a
    jerk of at most J rise / angle^3 that times J/16 (1 - sqrt(1 - 32/J)), J at least 32.

    Source: derived here, as a linear programme.
    """

    intervals: int = quantity("intervals of the acceleration", default=20, at_least=3, at_most=400, whole=True)
    rise: float | None = _lift("how far it moves, positive outward")
    end_lift: float | None = _lift("lift above the base circle where it ends")
    rise_deg: float | None = _lift("how far an arm swings, positive outward", "deg")
    end_lift_deg: float | None = _lift("an arm's lift where it ends", "deg")
    jerk_limit: float | None = quantity(
        "largest jerk, as a multiple of rise / angle^3; cycloidal has 39.5, 3-4-5 has 60",
        default=None,
        above=0,
        at_most=1e6,
    )
    kind: Literal["optimised-spline"] = "optimised-spline"
    start_deg: float | None = _angle("cam angle where it starts")
    end_deg: float | None = _angle("cam angle where it ends")
    duration_deg: float | None = _angle("cam angle it takes")


# Those that move to a lift, those whose start and end are given as angles, those that bring their own points.
Moving = Rise | LiftPolynomial | OptimisedPolynomial | OptimisedSpline
Timed = Dwell | Return | Moving
Pointed = LiftSpline | LiftTable
Segment = Timed | Pointed
OneSegment = Annotated[Segment, OneOfKinds()]
