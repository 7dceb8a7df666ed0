"""Six-bars: a four-bar that moves an output link through a second dyad."""

from __future__ import annotations

from functools import cached_property

from ..core.fields import FARTHEST, ComplexPoint, entry, quantity
from ..core.records import record
from ..plane.vec import Array
from .linkage import AbstractLinkage, BodyPoints, Linkage, points_entry, with_points
from .named_linkages import FourBar


@record(checked=True)
class StephensonSixBar(AbstractLinkage):
    """Stephenson six-bar: a four-bar whose coupler point moves an output link through a connecting link.

    The output dwells while the coupler point runs along an arc about the far end of the connecting link, with the
    radius `link`. Joints for branches: `rocker_pin`, and `output_pin`: +1 puts it left of the line from the coupler
    point to the output pivot. Angles and `output_pivot` are measured from the four-bar's ground line.

    Parameters
    ----------
    four_bar : FourBar
        The first loop; its `coupler_point` moves the connecting link.
    link : float
        Connecting link from coupler point to output pin, mm; above 0.
    output : float
        Output link from its pivot to its pin, mm; above 0.
    output_pivot : complex
        Ground pivot of the output link, mm from the crank pivot.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    See Also
    --------
    WattSixBar, FourBar, Linkage, move
    """

    four_bar: FourBar
    link: float = quantity(
        "connecting link, from coupler point to output pin", "mm", above=0, at_most=FARTHEST, example=120
    )
    output: float = quantity("output link, from its pivot to its pin", "mm", above=0, at_most=FARTHEST, example=90)
    output_pivot: ComplexPoint = entry(
        "ground pivot of the output link, from the crank pivot, [x, y] in mm", example=130 + 100j
    )
    points: BodyPoints = points_entry()

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: bodies of the four-bar, then "link" and "output"."""
        return _with_dyad(self.four_bar, "coupler_point", "coupler", self.four_bar.coupler_point, self)


@record(checked=True)
class WattSixBar(AbstractLinkage):
    """Watt six-bar: two four-bars in series; a point of the first one's rocker moves an output link.

    Joints for branches: `rocker_pin`, and `output_pin`: +1 puts it left of the line from the rocker's point to the
    output pivot. Angles and `output_pivot` are measured from the first four-bar's ground line.

    Parameters
    ----------
    four_bar : FourBar
        The first loop.
    rocker_point : complex
        Point of the rocker that moves the second coupler, mm from its ground pivot, x towards the rocker pin.
    link : float
        Second coupler, from rocker point to output pin, mm; above 0.
    output : float
        Output link from its pivot to its pin, mm; above 0.
    output_pivot : complex
        Ground pivot of the output link, mm from the crank pivot.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    See Also
    --------
    StephensonSixBar, FourBar, Linkage, move
    """

    four_bar: FourBar
    rocker_point: ComplexPoint = entry(
        "point of the rocker that drives on, from its ground pivot, x towards the rocker pin, [x, y] in mm",
        example=50 - 30j,
    )
    link: float = quantity(
        "second coupler, from rocker point to output pin", "mm", above=0, at_most=FARTHEST, example=90
    )
    output: float = quantity("output link, from its pivot to its pin", "mm", above=0, at_most=FARTHEST, example=60)
    output_pivot: ComplexPoint = entry(
        "ground pivot of the output link, from the crank pivot, [x, y] in mm", example=180 + 0j
    )
    points: BodyPoints = points_entry()

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: bodies of the four-bar, then "link" and "output"."""
        return _with_dyad(self.four_bar, "rocker_point", "rocker", self.rocker_point, self)


def _with_dyad(
    four_bar: FourBar, point: str, body: str, place: complex | Array, sizes: StephensonSixBar | WattSixBar
) -> Linkage:
    first = four_bar.linkage
    bodies = {name: dict(points) for name, points in first.bodies.items()}
    bodies[body][point] = place
    bodies["ground"]["output_pivot"] = sizes.output_pivot
    bodies["link"] = {point: 0j, "output_pin": sizes.link + 0j}
    bodies["output"] = {"output_pivot": 0j, "output_pin": sizes.output + 0j}
    return Linkage(bodies, first.driver, (), first.origin, first.ground_angle_deg)
