"""Tips that the root fillets of racks and pinion cutters round: the tool rolled past the tooth by brute force."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.plane.flatten import flatten
from tests.campaign import by_default

RACK, PINION = gk.gear.RackCutter, gk.gear.PinionCutter
# Fillets that touch the flank, and those that cross it behind a cusp of their envelope.
GEARS = {
    "touching": lambda: gk.SpurGear(60, 1, 0, RACK(fillet_radius=0.4)),
    "shifted down": lambda: gk.SpurGear(17, 1, -0.2, RACK(fillet_radius=0.58), tooth_thickness_allowance=0.05),
    "crossing": lambda: gk.SpurGear(24, 1, 0, RACK(fillet_radius=0.2)),
    "ring": lambda: gk.RingGear(60, 1, 0, PINION(fillet_radius=0.2), 0.8),
    "touched ring": lambda: gk.RingGear(60, 1, 0, PINION(fillet_radius=0.5), 0.7),
}


def clearances(gear, z, steps=301):
    """Least distance of each point from the tool while that rolls past, mm; negative where it cuts deeper."""
    edge, _ = gear.tool(0.0)
    points = flatten(edge, 1e-4)
    if not gear.is_ring:
        points = np.append(points, [points[-1] + 5j, points[0] + 5j])
    tool = shapely.Polygon(np.column_stack([points.real, points.imag]))
    line = tool.exterior if gear.is_ring else shapely.LineString(list(tool.exterior.coords)[: len(points) - 2])
    shapely.prepare(tool)
    least = np.full(z.shape, np.inf)
    for turn in np.linspace(-4, 4, steps) * np.pi / gear.teeth:
        pose = gear.tool(turn)[1]
        w = (z * np.exp(1j * turn) - complex(pose.origin)) / complex(pose.direction)
        away = shapely.distance(line, shapely.points(w.real, w.imag))
        least = np.minimum(least, np.where(shapely.contains_xy(tool, w.real, w.imag), -away, away))
    return least


@pytest.mark.parametrize("name", by_default(GEARS, ["touching", "crossing"]))
def test_the_tool_leaves_just_this_tooth(name):
    gear = GEARS[name]()
    assert gear.tip_edge is not None
    z = np.concatenate([c.point(np.linspace(c.breaks[0], c.breaks[-1], 12)[1:-1]) for c in gear.regions.values()])
    if gear.tooth_thickness_allowance:
        z = z[np.abs(z) > 0]
    near = clearances(gear, z)
    assert near.min() > -2e-4 and near.max() < 2e-3
    joints = [c.point(c.breaks[[0, -1]]) for c in gear.regions.values()]
    assert np.abs([b[0] - a[1] for a, b in zip(joints, joints[1:])]).max() < 1e-9
    # It ends tangent to the tip circle, and less of the flank is in contact than without.
    edge = gear.tip_edge
    assert abs(edge.point(edge.breaks[-1])) == pytest.approx(gear.tip_radius)
    along = complex(edge.velocity(edge.breaks[-1])) * np.conj(complex(edge.point(edge.breaks[-1])))
    assert abs(along.real) < 1e-9 * abs(along)


def test_a_fillet_shortens_contact_and_leaves_the_sharp_teeth_without_it():
    plain, filleted = (gk.SpurGear(60, 2, rack=RACK(fillet_radius=r)) for r in (0, 0.4))
    assert gk.GearPair(filleted, filleted).contact_ratio < gk.GearPair(plain, plain).contact_ratio
    assert filleted.form_radius == plain.form_radius
    rack = gk.gear.GearRack(12, 2, RACK(fillet_radius=0.4))
    assert gk.gear.RackPair(plain, rack).contact_ratio < gk.gear.RackPair(plain, gk.gear.GearRack(12, 2)).contact_ratio
    # The limit of many teeth is the rack: an arc that ends where both are level, and as high.
    top = flatten(rack.outline, 1e-5)
    assert top.imag.max() == pytest.approx(2)
    many = gk.SpurGear(10_000, 2, rack=RACK(fillet_radius=0.4)).tip_edge
    z = many.point(np.linspace(*many.breaks[[0, -1]], 9)) - 10_000j
    assert gk.nearest(rack.outline, z)[1].max() < 1e-3


@pytest.mark.parametrize(
    ("key", "make"),
    [
        ("fillet_radius", lambda: RACK(fillet_radius=0.7)),
        ("addendum", lambda: gk.SpurGear(24, 2, rack=RACK(fillet_radius=0.2), addendum=0.9)),
        ("tip_rounding", lambda: gk.SpurGear(24, 2, rack=RACK(fillet_radius=0.2), tip_rounding=0.1)),
        ("cutter.fillet_radius", lambda: gk.RingGear(60, 2, 0, PINION(fillet_radius=0.9), 0.7)),
        ("cutter.fillet_radius", lambda: gk.RingGear(60, 2, 0, PINION(fillet_radius=0.02))),
    ],
)
def test_fillets_without_room_are_refused(key, make):
    with pytest.raises(gk.DesignError) as refused:
        make()
    assert refused.value.field == key
