"""What is attached to bodies: arms, hubs and pulleys that a body drives, and linear actuators that drive a slide."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated, Any

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, ComplexPoint, entry, quantity, to_digits
from ..core.names import VisibleName
from ..core.records import record
from ..core.units import mm
from ..model.check import Check, Suggestion
from ..model.motor import LinearActuator
from ..model.part import HoleFit
from ..plane.primitives import Circle
from ..plane.vec import Real, direction_deg, spaced_directions
from .assembly import Bill
from .bores import SMALLEST
from .fasteners import Fastener, ThreadDiameter, screw_text, size_of
from .materials import NamedIn
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
        """Least ratio of the force that it moves at each speed to that required; nan if a force is unknown."""
        supplied, required = actuator.force_at(self.speed), np.abs(self.force)
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.min(np.where(required == 0, np.inf, supplied / required)))

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


# Most screws of an attachment.
MOST_BOLTS = 24


@record(checked=True)
class Attachment:
    """What is screwed to a plate: the holes for its screws, and one for its shaft or hub.

    Raises
    ------
    DesignError
        If it has screws on a circle without a diameter, or a diameter without screws, or two of its holes meet.
    """

    name: VisibleName = entry("what is attached, for the bill and the assembly steps", example="hub with a set screw")
    holes: tuple[ComplexPoint, ...] = entry(
        "positions of its screws, [x, y] in mm from its middle; by default one in the middle, unless it has bolts",
        default=(),
    )
    bolts: int = quantity(
        "number of screws on a circle", whole=True, default=0, at_least=0, at_most=MOST_BOLTS, example=3
    )
    bolt_circle: float | None = quantity(
        "diameter of the circle of the screws", "mm", default=None, above=0, at_most=FARTHEST, example=17
    )
    bore: float = quantity(
        "diameter of its shaft or hub, which passes through its middle; 0 for none", "mm", default=0.0, at_least=0,
        at_most=FARTHEST,
    )  # fmt: skip
    angle_deg: float = quantity(
        "its rotation about its middle; at 0 the first bolt is on +x", "deg", default=0.0, at_least=-360, at_most=360
    )
    screw: ThreadDiameter = quantity(
        'diameter of its screws, or their thread, as "#6-32"; their holes are wider by the clearance', "mm",
        default=3.0, at_least=SMALLEST, at_most=FARTHEST,
    )  # fmt: skip
    thickness: float = quantity(
        "its thickness under the screws, for their length", "mm", default=3.0, at_least=0, at_most=1000
    )
    set_screw: bool = entry("whether a set screw fixes it on the shaft in its middle, as a hub's", default=False)

    def __post_init__(self) -> None:
        if self.bolts and self.bolt_circle is None:
            remedy = "give the diameter of their circle, or omit bolts"
            raise DesignError("bolt_circle", f"is missing for {self.bolts} bolts", remedy, "missing-key")
        if self.bolt_circle is not None and not self.bolts:
            raise DesignError("bolts", "is missing", "give their number, or omit bolt_circle", "missing-key")

    @property
    def at_screws(self) -> tuple[complex, ...]:
        """Positions of the screws from its middle, mm."""
        circle = (self.bolt_circle or 0.0) / 2 * spaced_directions(self.bolts)
        plain = [*self.holes, *circle.tolist()] or ([] if self.bore else [0j])
        return tuple((np.array(plain, dtype=complex) * direction_deg(self.angle_deg)).tolist())

    def openings(self, middle: complex, clearance: float) -> Iterator[tuple[complex, HoleFit]]:
        """Centre of each hole, mm, and its fit: the bore, then the screws. middle: in the frame of the plate."""
        if self.bore:
            yield middle, HoleFit(self.bore, clearance)
        for place in self.at_screws:
            yield middle + place, HoleFit(self.screw, clearance)

    def check(self, middle: complex, clearance: float, key: str) -> None:
        """DesignError if two of its holes meet. key: of the attachment in the recipe."""
        openings = list(self.openings(middle, clearance))
        for k, (place, fit) in enumerate(openings):
            for other, other_fit in openings[:k]:
                apart, needed = abs(place - other), (fit.diameter + other_fit.diameter) / 2 + clearance
                if apart <= needed:
                    problem = f"two holes of the {self.name} are {mm(apart):.4g} apart, and meet below {mm(needed):.4g}"
                    raise DesignError(key, problem, "give other holes, a larger bolt_circle or thinner screws")

    def bill(self, sheet: float) -> Bill:
        """What is attached, with its screws through a sheet of a thickness, mm."""
        count = len(self.at_screws)
        screws = Fastener(self.screw, "screw", 0.0).bill(sheet + self.thickness) if size_of(self.screw) else ()
        return ((self.name, 1), *((item, count * number) for item, number in screws))

    def projections(self, sheet: float) -> tuple[float, float]:
        """How far it and the heads of its screws project on one side of a sheet of a thickness, mm, and nuts there."""
        head, nut = Fastener(self.screw, "screw", 0.0).ends(sheet + self.thickness)
        return self.thickness + head, nut

    def step(self, plate: str) -> str:
        """The assembly step that fixes it."""
        count = len(self.at_screws)
        by = f", by {count} x {screw_text(self.screw)}" if count else ""
        through = f", its shaft of {mm(self.bore):g} through the plate" if self.bore else ""
        fixed = "; tighten its set screw on the shaft" if self.set_screw else ""
        return f"fix the {self.name} on the {plate}{by}{through}{fixed}"


def attached_holes(attachments: Iterable[tuple[Attachment, complex]], clearance: float) -> tuple[Circle, ...]:
    """The holes of attachments, each with its middle in the frame of the plate, mm."""
    return tuple(
        Circle(place, (fit.diameter + fit.play) / 2)
        for attachment, middle in attachments
        for place, fit in attachment.openings(middle, clearance)
    )


def hub_thickness(items: Iterable[Attachment]) -> float:
    """Length of a shaft that hubs with set screws engage, mm."""
    return max((item.thickness for item in items if item.set_screw), default=0.0)


def attachments_entry(what: str) -> Any:
    """Field for the attachments of a stock."""
    keys = "each with name, holes or bolts, bolt_circle, bore and screw"
    meaning = f"what {what} drives, such as an arm, a bracket, a hub with a set screw or a pulley, {keys}"
    return entry(meaning, default=())
