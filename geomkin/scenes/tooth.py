"""The regions of a gear's tooth as curves: what the flank is, what the tool leaves below it, and what it takes away."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..gear.contract import AbstractInvoluteGear
from ..gear.involute import roll_at
from ..plane.curve import AbstractCurve
from ..plane.derived import Moved
from ..plane.primitives import Arc
from ..plane.roulettes import Involute
from ..plane.vec import Pose
from ..scene import Role, SceneCurve


def tooth_regions(gear: AbstractInvoluteGear, name: str) -> Iterator[SceneCurve]:
    """Right-hand side of the tooth on +y of a gear called `name`, region by region, mm in its frame.

    Of an undercut tooth also the involute that is lost, from the base circle to where the root curve crosses it.
    Derived here.
    """
    root, tip = gear.root_curve, gear.tip_edge or gear.flank
    low, high = complex(root.point(root.breaks[0])), complex(tip.point(tip.breaks[-1]))
    # Lands reach as far on the other side of the tooth's and the space's middle.
    other = -low.conjugate() * np.exp(-2j * np.pi / gear.teeth)
    regions: list[tuple[str, Role, AbstractCurve]] = [
        ("involute flank", "traced", gear.flank),
        ("root curve, as the tool leaves it", "contact", root),
        ("bottom land", "construction", Arc(0j, other, float(np.angle(low / other)))),
        ("tip land", "construction", Arc(0j, high, 2 * float(np.arctan2(high.real, high.imag)))),
    ]
    if gear.tip_edge:
        regions.append(("broken edge of the tip", "construction", gear.tip_edge))
    if gear.is_undercut:
        whole = Involute(gear.base_radius, 0.0, roll_at(gear.form_radius, gear.base_radius))
        cusp = complex(1j * np.exp(-1j * gear.tooth.half_angle(gear.base_radius)))
        regions.append(("involute lost to undercut", "wanted", Moved(whole, Pose(0j, cusp))))
    for label, role, curve in regions:
        yield SceneCurve(curve, role, label, name)
