"""What a cam and its follower turn on and are held by, as it is bought."""

from __future__ import annotations

from ..arguments import checked
from ..cam.cam import Cam
from ..part import Bought
from .base import BaseStock
from .cam import CamStock
from .fasteners import gathered
from .shafts import pin_bill, screw_bill, shaft_bill


@checked
def cam_bought(cam: Cam, stock: CamStock = CamStock(), base: BaseStock | None = None) -> tuple[Bought, ...]:
    """The cam's shaft and key, the pins of its follower and the base's screws, for the parts by their names.

    A shaft or pin is as long as all plates on it are thick, with the base that holds or guides it. Bearings are not
    told. Derived here.
    """
    follower, thick = cam.follower, stock.thickness
    plates = follower.plates if base is None else follower.guided_plates
    # Holes of one name in two plates are on one pin; two in one plate are on a pin each.
    pins: dict[tuple[str, int], list[tuple[str, float]]] = {}
    for plate in plates(stock.bars, cam.program, cam.base_radius, cam.sense):
        keys = [hole.key for hole in plate.holes]
        for k, hole in enumerate(plate.holes):
            pins.setdefault((hole.key, keys[:k].count(hole.key)), []).append((plate.name, hole.diameter))
    held = 0.0 if base is None else thick
    lines = [("cam", shaft_bill(stock, thick + held, base=held))]
    for (key, _), on in pins.items():
        in_base = held if key == "pivot_bore" else 0.0
        lines.append((on[0][0], pin_bill(on[0][1], len(on) * thick + in_base)))
    return gathered(lines if base is None else [*lines, ("base", screw_bill(base, thick))])
