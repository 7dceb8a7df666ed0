"""Walls of parts whose section moves as it goes up, by slices cut one by one, of any size."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.model.machinability import thinnest_walls, wall_checks
from geomkin.model.part import Twist
from geomkin.plane.primitives import slot

PITCH = 2 * np.pi / 14
RAIL = np.array([0, 30, 30 + 8j, 26 + 11j, 22 + 8j, 8j])
# Arms 1.5 mm wide, whose sides are nearer to each other than the bore is to the outline.
ARMS = np.concatenate([1j**k * np.array([3 - 0.75j, 8 - 0.75j, 8 + 0.75j, 3 + 0.75j]) for k in range(4)])
RIM = np.array([-12 - 12j, 12 - 12j, 12 + 10j, 10 + 12j, -12 + 12j])


def rail(scale, *places):
    return gk.plane.Polyline(RAIL * scale), *(gk.plane.Circle((x + 4j) * scale, 2 * scale) for x in places)


# Outline and holes at a scale; how the section moves, shifts for a scale of 1.
CASES = {
    "teeth over slots": (
        lambda s: (gk.SpurGear(14, s).outline, slot((1 - 2j) * s, (1 + 2j) * s, s), slot(-3.5 * s, -3 * s, s)),
        {"turn": PITCH},
    ),
    "teeth over a bore off the middle": (
        lambda s: (gk.SpurGear(14, s).outline, gk.plane.Circle(1.5 * s, 3 * s)), {"turn": -1.5 * PITCH},
    ),
    "herringbone": (lambda s: (gk.SpurGear(14, s).outline, gk.plane.Circle(1j * s, 3.3 * s)),
                    {"turn": PITCH, "herringbone": True}),
    "arms that are thinner than their hub": (
        lambda s: (gk.plane.Polyline(ARMS * s), gk.plane.Circle(0j, 0.5 * s)), {"turn": 0.7},
    ),
    "a ring whose teeth turn": (
        lambda s: (gk.plane.Polyline(RIM * s), gk.plane.Reversed(gk.SpurGear(14, s).outline)),
        {"turn": PITCH, "moves": "holes"},
    ),
    "ears thinner than their ring": (
        lambda s: (gk.plane.Polyline(ARMS * s), gk.plane.Polyline(0.5 * s * 1j ** np.arange(4))),
        {"turn": 0.7, "moves": "holes"},
    ),
    "rail to the left": (lambda s: rail(s, 9, 21), {"shift": -6.0}),
    "rail to the right": (lambda s: rail(s, 9, 24), {"shift": 6.5}),
    # Nearer to each other than the rail slides.
    "holes side by side": (lambda s: rail(s, 15, 19.5), {"shift": 5.0}),
    "a slot along the rail": (
        lambda s: (gk.plane.Polyline(RAIL * s), slot((8 + 4j) * s, (20 + 4j) * s, 2.5 * s)), {"shift": 3.0},
    ),
}  # fmt: skip


def part_of(case, scale):
    curves, moves = CASES[case]
    outline, *holes = curves(scale)
    twist = Twist(**moves | {"shift": moves.get("shift", 0.0) * scale})
    return gk.Part("plate", outline, tuple(holes), 2.0 * scale, twist=twist)


def slices(part, scale):
    """Sections at many heights, as polygons of a scale of 1."""
    loops = [gk.flatten(curve, 1e-3 * scale) / scale for curve in (part.outline, *part.holes)]
    moves = [(k == 0) == (part.twist.moves == "outline") for k in range(len(loops))]
    for share in np.linspace(0, 1, 81):
        pose = part.twist.at(share)
        outline, *holes = (pose.origin / scale + pose.direction * z if m else z for z, m in zip(loops, moves))
        yield shapely.Polygon(gk.plane.xy(outline), [gk.plane.xy(hole) for hole in holes])


@pytest.mark.parametrize(("case", "scale"), list(zip(CASES, 4 * (1.0, 2e-3, 300.0))))
def test_the_thinnest_wall_is_the_least_of_all_slices_whatever_their_size(case, scale):
    part = part_of(case, scale)
    found = list(slices(part, scale))
    walls = [one.exterior.distance(hole) for one in found for hole in one.interiors]
    walls += [a.distance(b) for k, a in enumerate(found[0].interiors) for b in list(found[0].interiors)[:k]]
    least = 1.5 if "thinner" in case else min(walls)
    assert thinnest_walls([part], 0.1 * scale)["plate"] / scale == pytest.approx(least, abs=4e-3)
    # What is twisted is not cut from a sheet.
    assert wall_checks([part], 0.1 * scale) == ()
