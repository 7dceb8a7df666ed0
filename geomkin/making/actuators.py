"""Linear actuators that drive a slide: those of the table, the smallest one that suffices, and their checks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

import numpy as np

from ..core.fields import entry, to_digits
from ..core.records import record
from ..core.units import mm
from ..model.check import Check, Suggestion
from ..model.material import NamedIn
from ..model.motor import LinearActuator
from ..plane.vec import Real
from .motors import LEAST_MOTOR_MARGIN

_SOURCE = (
    "Actuonix L16 data sheet, the same in WestCoast Products' general data of it; full_load_speed by the straight line"
)
# By the ratio of their gears: largest force, N, speed without load, mm/s, and force and speed at the largest power.
_L16 = {35: (50.0, 32.0, 50.0, 16.0), 63: (100.0, 20.0, 75.0, 10.0), 150: (200.0, 8.0, 175.0, 4.0)}


def _l16(stroke: int, ratio: int) -> LinearActuator:
    """The straight line from the speed without load through the point of the largest power, to the largest force."""
    force, no_load, at_force, at_speed = _L16[ratio]
    full_load = no_load - (no_load - at_speed) * force / at_force
    return LinearActuator(f"L16, {ratio}:1, 12 V", force, no_load, to_digits(full_load, 4), float(stroke), _SOURCE)


# The shortest first, and of each stroke the weakest. The strokes, mm, are those of the same sheet.
ACTUATORS: dict[str, LinearActuator] = {f"l16-{s}-{ratio}": _l16(s, ratio) for s in (50, 100, 140) for ratio in _L16}
# Field type of an actuator in the tables of a recipe.
ActuatorKey = Annotated[LinearActuator, NamedIn(ACTUATORS, "actuator")]


def actuator_entry() -> Any:
    """The field for the actuator of a slide."""
    words = "or a table of name, force_n, no_load_speed, full_load_speed and stroke"
    return entry(f"linear actuator of a driven slide: {', '.join(ACTUATORS)}, {words}", default=None)


@record(eq=False)
class ActuatorDuty:
    """What an actuator must supply. force, speed: of the slide, N and mm/s, (frames,). stroke: of the slide, mm."""

    force: Real
    speed: Real
    stroke: float

    def margin(self, actuator: LinearActuator) -> float:
        """Least ratio of the force that it moves at each speed to that required; nan if all are unknown."""
        known = np.isfinite(self.force)
        supplied, required = actuator.force_at(self.speed)[known], np.abs(self.force[known])
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.where(required > 0, supplied / required, np.inf)
        return float(np.min(ratios, initial=np.inf)) if known.any() else float("nan")

    @property
    def suitable(self) -> str | None:
        """Name of the first of the table that suffices; None if none does."""
        long = (name for name, actuator in ACTUATORS.items() if actuator.stroke >= self.stroke)
        return next((name for name in long if self.margin(ACTUATORS[name]) >= LEAST_MOTOR_MARGIN), None)

    @property
    def remark(self) -> str:
        """The force, speed and stroke that are needed, and the actuator that has them, or the nearest."""
        needed = (
            f"The slide needs an actuator of {LEAST_MOTOR_MARGIN * float(np.nanmax(np.abs(self.force))):.4g} N at "
            f"{mm(float(self.speed.max()), unit='mm/s'):.4g}, {LEAST_MOTOR_MARGIN:g} times the largest force, with a "
            f"stroke of {mm(self.stroke):.6g}"
        )
        if suitable := self.suitable:
            return f"{needed}: {suitable} suffices."
        nearest = max(
            ACTUATORS, key=lambda name: (min(self.margin(ACTUATORS[name]), LEAST_MOTOR_MARGIN), ACTUATORS[name].stroke)
        )
        margin = to_digits(self.margin(ACTUATORS[nearest]), 3)
        own = f"{nearest}, which has {margin:g} times the force and a stroke of {mm(ACTUATORS[nearest].stroke):g}"
        return f"{needed}; none of the table suffices, and the nearest is {own}."

    def checks(self, actuator: LinearActuator) -> Iterator[Check]:
        """That an actuator supplies the force at each speed, by the margin of motors, and has the stroke."""
        better = self.suitable
        change = f'give actuator = "{better}"' if better else ""
        suggestions = (Suggestion({"loads.actuator": better}),) if better else ()
        largest, speed = np.nanmax(np.abs(self.force), initial=0.0), mm(float(self.speed.max()), unit="mm/s")
        advice = (
            f"{largest:.4g} N at up to {speed:.4g} are required: {change or 'move it slower, or give a stronger one'}"
        )
        name, limit = f"force of the {actuator.name} to that required", LEAST_MOTOR_MARGIN
        yield Check(
            "actuator_force", name, self.margin(actuator), "at least", limit, "", advice, "driver_force",
            suggestions=suggestions,
        )  # fmt: skip
        shorter = f"let it move by at most {mm(actuator.stroke):down}, or give a longer one"
        advice = f"the slide moves by {mm(self.stroke):.6g}: {change or shorter}"
        name, ratio = (
            f"stroke of the {actuator.name} to that of the slide",
            to_digits(actuator.stroke / self.stroke, 12),
        )
        yield Check("actuator_stroke", name, ratio, "at least", 1.0, "", advice, suggestions=suggestions)
