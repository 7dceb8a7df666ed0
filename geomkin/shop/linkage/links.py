"""Bars and plates of a linkage."""

from __future__ import annotations

from ...arguments import checked
from ...errors import DesignError
from ...linkage.linkage import Linkage
from ...linkage.motion import Motion
from ...part import Part
from ...plane.primitives import Circle, rounded_hull, slot
from .plates import LinkStock, Plate, assemble
from .stack import Stack


@checked
def link_parts(motion: Motion, stock: LinkStock = LinkStock(), stack: Stack | None = None) -> tuple[Part, ...]:
    """The plates of a linkage, each in its body's own frame: holes for pins and traced points, slots for slides.

    motion: over the whole way that the linkage is to go; slots are as long as the travel over its frames. stack:
    `stack_links(motion, stock)`, where the plates are to lie on each other so that nothing collides: a bridge that it
    needs is one more plate, and the discs that hold the bridge up are the part `spacer`, as many as its count says.
    Without it, the fixed body is one plate. Raises DesignError where no frame closes, where openings run into each
    other, where guide pins find no room, and for many linkages at once. Derived here.
    """
    plates = stack.plates if stack else assemble(motion, stock).plates
    parts = [_part(name, plate, stock, motion.linkage) for name, plate in plates.items()]
    if stack and stack.spacers:
        disc, hole = Circle(0j, stock.bar_width / 2), Circle(0j, stock.hole_diameter / 2)
        parts.append(Part("spacer", disc, (hole,), stock.thickness, count=stack.spacers))
    return tuple(parts)


def _part(name: str, plate: Plate, stock: LinkStock, linkage: Linkage) -> Part:
    for one, two, apart in plate.crossings(stock):
        traced = [p for p in (two, one) if p in linkage.bodies[plate.body] and p not in linkage.pins]
        kinds = [f"{'hole' if len(plate.openings[p]) == 1 else 'slot'} of {p}" for p in (one, two)]
        raise DesignError(
            traced[0] if traced else plate.body,
            f"the {kinds[0]} and the {kinds[1]} in the {name} are {apart:.4g} mm apart, "
            f"and they are {stock.hole_diameter:g} mm wide",
            "change the sizes that bring them together, or give a smaller pin_diameter",
        )
    radius = stock.hole_diameter / 2
    # Two guide pins may share one slot.
    holes = tuple(
        Circle(ends[0], radius) if len(ends) == 1 else slot(ends[0], ends[1], radius)
        for ends in dict.fromkeys(plate.openings.values())
    )
    return Part(name, rounded_hull(plate.centres, stock.bar_width / 2), holes, stock.thickness)
