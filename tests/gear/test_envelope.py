"""The boundary of what a tooth sweeps: where it goes on, how exactly its curves cross, and what that costs."""

from types import SimpleNamespace

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.conjugate.conjugate import conjugate
from geomkin.gear.conjugate.conjugate_curve import ToothRun
from geomkin.gear.conjugate.envelope import GRID, Swept
from geomkin.gear.conjugate.shaping_gears import LanternPinion, StraightSidedGear
from geomkin.plane.curve import SubCurve
from geomkin.plane.roulettes import Cycloid


def straight():
    gear = StraightSidedGear(100, 2, 25, 1.0, 1.2)
    return conjugate(gear.cutter(0.4), 100, gear.pitch_radius, 30, 2.0)


def lantern():
    return conjugate(LanternPinion(12, 4, 5.5).cutter(0.5, 0.2), 12, 24.0, 48, 7.0)


def test_curves_of_the_boundary_meet_to_rounding_where_they_cross():
    """Teeth undercut more and less, down to a ten-thousandth beyond the limit."""
    crossings = 0
    for height in (0.8, 0.5, 0.305, 0.3012, 0.3):
        gear = StraightSidedGear(40, 2, 20, height, 1.2)
        mate = conjugate(gear.cutter(0.0), 40, gear.pitch_radius, 9, 1.5)
        for one, two in zip(mate.steps, mate.steps[1:]):
            end, start = complex(one.curve.point(one.end)), complex(two.curve.point(two.start))
            assert abs(end - start) < 1e-12 * mate.pitch_radius
            crossings += one.end not in (one.curve.start, one.curve.end)
    assert crossings >= 4


PLACE = 30 + 40j


def bend(curvature, long, way):
    """An arc from PLACE along a direction, as a curve of the boundary: its length from 0 to `long`."""

    def point(t):
        return PLACE + 1j * way * (1 - np.exp(1j * curvature * np.asarray(t))) / curvature

    return SimpleNamespace(point=point, start=0.0, end=long)


@pytest.mark.parametrize("longer", [40.0, 0.05])
@pytest.mark.parametrize(("bends", "outer"), [((-0.02, -0.021), 2), ((0.02, 0.021), 1), ((-0.06, -0.021), 1)])
def test_of_curves_that_leave_together_the_one_farthest_out_is_walked(longer, bends, outer):
    """Two arcs that touch where they begin: at one distance the one bent more to the right, whatever their grids.

    One may end before that distance.
    """
    # One way of theirs lies so that half a turn is between what both lean together.
    lean = [0.05 * bend for bend in bends]
    for way in np.exp(1j * np.append(np.radians(range(0, 360, 30)), np.pi / 2 - (3 * lean[0] + lean[1]) / 4)):
        arrives = SimpleNamespace(point=lambda t, way=way: PLACE + way * (np.asarray(t) - 1), start=0.0, end=1.0)
        curves = [arrives, bend(bends[0], longer, way), bend(bends[1], 1.1, way)]
        grids = [c.start + (c.end - c.start) * GRID for c in curves]
        swept = Swept(curves, [1, 1, 1], [c.point(g) for c, g in zip(curves, grids)], grids, 100.0)
        assert swept._next(0, PLACE, 1) == outer


@pytest.mark.parametrize(("rolling", "pieces"), [(3.0, (0, 1)), (-4.0, (-1, 0)), (3.0, (-1, 0, 1))])
def test_at_a_cusp_the_tangent_is_that_just_inside(rolling, pieces):
    """Of the piece that begins there, or where none does of the one that ends."""
    breaks = 2 * np.pi * abs(rolling) / 20 * np.array(pieces, dtype=float)
    run = ToothRun(SubCurve(Cycloid(20.0, rolling, breaks[0], breaks[-1]), breaks))
    places = np.array([0.0, 0.6 * breaks[0] + 0.4 * breaks[1]])
    found, inside = run.touch(places), -1e-5 if breaks[-1] == 0 else 1e-5
    near = run.curve.velocity(places + np.array([inside, 0]))
    assert np.abs(np.angle(found.tangent / near)).max() < 1e-3
    assert found.speed == pytest.approx(np.array([0, abs(near[1])]), abs=1e-3)
    assert (found.point == run.curve.point(places)).all() and np.isfinite(found.turning).all()


def mate_in_a_ring():
    gear = StraightSidedGear(40, 2, 20, 0.8, 1.2)
    return conjugate(gear.cutter(0.2, 0.1), 40, 40.0, 70, 1.8, True)


def pinion_of_a_ring():
    gear = gk.RingGear(60, 2)
    piece = gk.plane.Reversed(gk.plane.Reversed(gear.outline.piece))
    return conjugate(piece, 60, 60.0, 24, 1.5, True)


@pytest.mark.parametrize("make", [straight, lantern, mate_in_a_ring, pinion_of_a_ring])
def test_tips_are_as_thick_as_they_are_drawn_and_contact_lasts_as_long_as_a_tooth_turns(make):
    mate = make()
    assert mate.module == pytest.approx(2 * mate.pitch_radius / mate.teeth)
    assert mate.distance == pytest.approx(abs(mate.pose.origin))
    z = gk.flatten(mate.outline, 1e-5)
    land = np.abs(np.abs(z) - mate.tip_radius) < 1e-9
    assert np.abs(z).min() == pytest.approx(mate.tip_radius if mate.is_ring else mate.root_radius, abs=1e-4)
    assert np.abs(z).max() == pytest.approx(mate.root_radius if mate.is_ring else mate.tip_radius, abs=1e-4)
    # The tooth on +y: its land is all that lies on the tip circle within half a pitch.
    top = np.angle(z[land & (np.abs(np.angle(z / 1j)) < np.pi / mate.teeth)] / 1j)
    assert mate.tip_thickness == pytest.approx(mate.tip_radius * np.ptp(top), abs=1e-6)
    # From where the gear's tooth first touches to where it last does, looked at closely beside what never does.
    first, last = mate.tooth.breaks[[0, -1]]
    beside = np.array([[u.start, u.end] for u in mate.untouched]).ravel()[:, None] + np.array(
        [-1e-5, -1e-9, 1e-9, 1e-5]
    )
    places = np.union1d(np.linspace(first, last, 3001), beside)
    for start, end in ((first, last), (first, 0.5 * (first + last)), (0.2 * first + 0.8 * last, last)):
        angle = mate.contact(np.union1d(places[(places >= start) & (places <= end)], [start, end])).angle
        turned = np.ptp(angle[np.isfinite(angle)]) if np.isfinite(angle).any() else 0.0
        assert mate.contact_ratio(start, end) == pytest.approx(turned * mate.gear_teeth / (2 * np.pi), abs=0.03)
    assert mate.contact_ratio(last, last) == 0
