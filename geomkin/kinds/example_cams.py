"""Cams that templates show: each follower, each segment, and lifts that go with them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from ..cam.followers.flat import OscillatingFlat, TranslatingFlat
from ..cam.followers.roller import OscillatingRoller, TranslatingRoller
from ..cam.program.program import Dwell, Program, Return, Rise
from ..cam.program.segments import LiftPolynomial, LiftSpline, LiftTable, OptimisedPolynomial, OptimisedSpline
from ..recipe.template import example

FOLLOWERS: dict[str, Any] = {
    table.kind: table for table in (TranslatingRoller, TranslatingFlat, OscillatingRoller, OscillatingFlat)
}
# Of a cycloidal rise, so that the curve through them rests at both ends.
ROWS = ((120.0, 0.0), (140.0, 0.577), (160.0, 3.91), (180.0, 10.0), (200.0, 16.09), (220.0, 19.423), (240.0, 20.0))
# Of each kind of segment one that lifts a follower from rest at 120 deg to rest at 240 deg.
LIFTS = {
    "rise": Rise("3-4-5", rise=20, end_deg=240),
    "polynomial": LiftPolynomial(
        rise=20, end_deg=240, start_velocity_per_rad=0, start_acceleration_per_rad2=0,
        end_velocity_per_rad=0, end_acceleration_per_rad2=0,
    ),
    "optimised-polynomial": OptimisedPolynomial(rise=20, end_deg=240),
    "optimised-spline": OptimisedSpline(rise=20, end_deg=240),
    "spline": LiftSpline(points=ROWS),
    "table": LiftTable(3, rows=ROWS),
}  # fmt: skip


def fit(asked: Mapping[str, str]) -> dict[str, Any]:
    """Follower and programme of the kinds asked for; an arm's lifts are angles, as many degrees as the others mm."""
    follower: Any = example(FOLLOWERS[asked.get("cam.follower", "translating-roller")])
    lift: Any = LIFTS.get(asked.get("cam.program", "rise"), LIFTS["rise"])
    if follower.oscillates:
        in_mm = [field.name for field in fields(lift) if hasattr(lift, f"{field.name}_deg")]
        lift = replace(
            lift, **{name: None for name in in_mm}, **{f"{name}_deg": getattr(lift, name) for name in in_mm}
        )  # fmt: skip
    return {
        # A flat face on an arm undercuts a smaller cam.
        "cam.base_radius": 60 if isinstance(follower, OscillatingFlat) else 40,
        "cam.follower": follower,
        "cam.program": Program((Dwell(end_deg=120), lift, Return("cycloidal", end_deg=360))),
    }
