"""What a body drives, such as an arm, a bracket, a hub with a set screw or a pulley: its holes, screws and mass."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, ComplexPoint, entry, quantity
from ..core.names import VisibleName
from ..core.records import record
from ..core.units import mm
from ..model.part import HoleFit
from ..plane.primitives import Circle
from ..plane.vec import direction_deg, spaced_directions
from .assembly import Bill
from .bores import SMALLEST
from .fasteners import Fastener, ThreadDiameter, screw_text, size_of

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
