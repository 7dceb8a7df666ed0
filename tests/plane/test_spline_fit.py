"""Smooth pieces of closed curves: distances from the exact curve both ways, joints, and copies in other frames."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.plane.approximation import smooth_pieces
from geomkin.plane.flatten import flatten

COUPLER = gk.CouplerCurve(gk.FourBar(100, 30, 90, 70, coupler_point=40 + 30j), "coupler_point")
CURVES = {
    "gear": gk.SpurGear(11, 3).outline,
    "undercut": gk.SpurGear(7, 3).outline,
    "coupler curve": COUPLER,
    "mirrored gear": gk.plane.Mirrored(gk.SpurGear(9, 4).outline),
    "moved gear": gk.plane.Moved(gk.SpurGear(12, 3).outline, gk.plane.Pose(30 - 5j, 0.6 + 0.8j)),
}


def points_of(piece, end):
    """Points of a piece: of a spline each cubic by Bernstein's polynomials, of an arc by its bulge."""
    t = np.linspace(0, 1, 20)
    if not len(piece.controls):
        return gk.plane.Polyline(np.array([piece.start, end]), np.array([piece.bulge]), is_closed=False).point(t)
    lengths, inner = np.diff(piece.knots), piece.controls[1:-1].reshape(-1, 2)
    # At a double knot the curve is on the line between the neighbours, divided as the lengths.
    before, after = inner[:-1, 1], inner[1:, 0]
    joints = (before * lengths[1:] + after * lengths[:-1]) / (lengths[1:] + lengths[:-1])
    ends = np.concatenate([piece.controls[:1], joints, piece.controls[-1:]])
    weights = (1 - t) ** 3, 3 * (1 - t) ** 2 * t, 3 * (1 - t) * t**2, t**3
    rows = zip(ends[:-1], inner[:, 0], inner[:, 1], ends[1:])
    return np.concatenate([sum(w * z for w, z in zip(weights, row)) for row in rows])


def ring(z):
    return shapely.LinearRing(np.column_stack([z.real, z.imag]))


@pytest.mark.parametrize("splines_only", [False, True])
@pytest.mark.parametrize("name", CURVES)
def test_pieces_are_within_the_tolerance_of_the_curve(name, splines_only):
    curve = CURVES[name]
    pieces = smooth_pieces(curve, 1e-3, False, 9, splines_only)
    starts = [piece.start for piece in pieces]
    found = np.concatenate([points_of(p, end) for p, end in zip(pieces, [*starts[1:], starts[0]])])
    exact = flatten(curve, 1e-4)
    for one, other in ((found, exact), (exact, found)):
        some = one[:: len(one) // 300 + 1]
        assert shapely.distance(ring(other), shapely.points(some.real, some.imag)).max() < 1e-3 + 2e-4
    assert ring(found).is_ccw
    if splines_only:
        assert all(len(piece.controls) for piece in pieces)


@pytest.mark.parametrize("name", CURVES)
def test_a_hole_has_the_same_pieces_in_the_other_direction(name):
    outline, hole = (smooth_pieces(CURVES[name], 1e-3, is_hole, 9) for is_hole in (False, True))
    assert sorted(len(piece.knots) for piece in outline) == sorted(len(piece.knots) for piece in hole)
    assert {np.round(piece.start, 6) for piece in outline} == {np.round(piece.start, 6) for piece in hole}
    assert sorted(np.round([p.bulge for p in outline], 9)) == sorted(np.round([-p.bulge for p in hole], 9))
