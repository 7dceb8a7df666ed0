"""Twisted solids read back from their files: closed, outward, and at every height the section turned as it should be."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.layout import box
from geomkin.export.mesh import solid_cut
from geomkin.export.solids import TRIANGLE, stl
from tests.export.crossed import section
from tests.made import Made

WIDTH = 12.0
KEYED = gk.gear.GearStock(thickness=WIDTH, bore=8, keyway_width=3, keyway_depth=1.4)
PARTS = Made(
    {
        "wheel": lambda: part(gk.SpurGear(17, 2), KEYED, gk.gear.Helix(25, "left")),
        "herringbone": lambda: part(gk.SpurGear(8, 4), KEYED, gk.gear.Helix(45, "right", True)),
        "ring": lambda: part(gk.RingGear(40, 2), gk.gear.RingStock(thickness=WIDTH), gk.gear.Helix(30)),
        "rack": lambda: part(gk.gear.GearRack(5, 2), KEYED, gk.gear.Helix(30)),
        "chevrons": lambda: part(gk.gear.GearRack(5, 2), KEYED, gk.gear.Helix(30, "left", True)),
    }
)


def part(gear, stock, helix):
    return gk.gear.gear_parts(gear, stock, helix=helix)[0]


def triangles(content):
    """(m, 3, 3), mm, as the file has them."""
    return np.frombuffer(content[84:], dtype=TRIANGLE)["corners"].astype(float)


def ring(curve):
    z = gk.flatten(curve, 2e-4)
    return shapely.LinearRing(np.column_stack([z.real, z.imag]))


def exact_volume(part):
    return (gk.area(part.outline) - sum(map(gk.area, part.holes))) * part.thickness


@pytest.mark.parametrize(("name", "tolerance"), [*((name, 0.02) for name in PARTS), ("wheel", 0.002)])
def test_every_section_of_the_file_is_the_exact_one_turned(name, tolerance):
    """What moves is where the advance along the pitch circle takes it; the keyway goes straight up."""
    part = PARTS[name]
    corners = triangles(stl(solid_cut(part, tolerance)))
    moves, still = [ring(part.outline)], [ring(hole) for hole in part.holes]
    if name == "ring":
        moves, still = still, moves
    side = -1 if name in ("wheel", "chevrons") else 1
    angle = 45 if name == "herringbone" else 25 if name == "wheel" else 30
    radius = {"wheel": 17.0, "herringbone": 16.0, "ring": 40.0}.get(name)
    for height in np.random.default_rng(1).uniform(0, WIDTH, 3):
        up = min(height, WIDTH - height) if name in ("herringbone", "chevrons") else height
        advance = side * up * np.tan(np.radians(angle))
        segments = section(corners, height)
        seen = np.concatenate([segments.ravel(), segments.mean(axis=1)])[:: len(segments) // 200 + 1]
        back = seen * np.exp(-1j * advance / radius) if radius else seen - advance
        off = [shapely.distance(shapely.points(back.real, back.imag), one) for one in moves]
        off += [shapely.distance(shapely.points(seen.real, seen.imag), one) for one in still]
        assert np.min(off, axis=0).max() < tolerance
        # Each curve is there, all round.
        lengths = np.abs(np.diff(segments, axis=1)).sum()
        assert lengths == pytest.approx(sum(one.length for one in (*moves, *still)), rel=5e-3)


@pytest.mark.parametrize("name", PARTS)
def test_the_file_is_closed_outward_and_without_flat_triangles(name, tolerance=0.3):
    part = PARTS[name]
    corners = triangles(stl(solid_cut(part, tolerance)))
    a, b, c = corners.swapaxes(0, 1)
    surface = np.linalg.norm(np.cross(b - a, c - b), axis=1)
    assert surface.min() > 0
    # Each edge once there and once back: closed, and all triangles the same way round.
    _, number = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    edges = np.stack([number.reshape(-1, 3), np.roll(number.reshape(-1, 3), -1, axis=1)], axis=-1).reshape(-1, 2)
    there, back = (np.unique(edge, axis=0) for edge in (edges, edges[:, ::-1]))
    assert len(there) == len(edges) and (there == back).all()
    found = np.vecdot(np.cross(b - a, c - b), a).sum() / 6
    assert abs(found - exact_volume(part)) < tolerance * surface.sum() / 2
    assert found == pytest.approx(exact_volume(part), rel=0.05 * tolerance + 2e-4)


def test_more_triangles_than_programs_show_are_refused_with_sizes_that_work():
    part = PARTS["wheel"]
    with pytest.raises(gk.DesignError, match="tolerance:") as caught:
        solid_cut(part, 1e-5)
    words = caught.value.remedy.split()
    least = float(words[words.index("least") + 1])
    assert solid_cut(part, least)
    # With hardly less it is reported again, and not the next wider one.
    with pytest.raises(gk.DesignError, match="triangles") as caught:
        solid_cut(part, least / 1.23)
    assert least / 1.23 < float(caught.value.remedy.split()[3]) < 1.05 * least
    thin = gk.Part(
        "thin", part.outline, part.holes, float(words[-2]), twist=gk.Twist(part.twist.turn * float(words[-2]) / WIDTH)
    )
    assert solid_cut(thin, 1e-5)


@pytest.mark.parametrize("moves", ["outline", "holes"])
@pytest.mark.parametrize(("turn", "shift"), [(-2.0, 0.0), (0.0, 7.0)])
def test_extent_of_a_twisted_part_holds_every_corner_of_its_solid(turn, shift, moves):
    square = gk.plane.Polyline(np.array([-20 - 12j, 20 - 12j, 20 + 12j, -20 + 12j]))
    twist = gk.Twist(turn, shift, moves=moves)
    made = solid_cut(gk.Part("leaning", square, (gk.plane.Circle(0j, 3.0),), 5.0, twist=twist), 0.01)
    assert made.is_twisted == (moves == "outline")
    low, high = made.box
    x, y, _ = triangles(stl(made)).reshape(-1, 3).T
    assert low.real <= x.min() + 1e-4 and low.imag <= y.min() + 1e-4
    assert high.real >= x.max() - 1e-4 and high.imag >= y.max() - 1e-4
    # So does its box on a sheet, in whole mm, whichever way it lies.
    for way in (1, 1j, -1, -1j):
        corner, size = box(made, way)
        z = (x + 1j * y) * way
        assert corner.real <= z.real.min() + 1e-4 and corner.imag <= z.imag.min() + 1e-4
        assert (corner + size).real >= z.real.max() - 1e-4 and (corner + size).imag >= z.imag.max() - 1e-4
        assert (corner, size) == (complex(np.round(corner)), complex(np.round(size)))
        room = np.array([low, complex(high.real, low.imag), high, complex(low.real, high.imag)]) * way
        assert size.real < np.ptp(room.real) + 2 and size.imag < np.ptp(room.imag) + 2
    # No larger than it takes at most: as far all round as its farthest corner, or as it slides.
    if moves == "holes" or shift:
        sizes = high - low, complex(np.ptp(x), np.ptp(y))
        assert sizes[0] == pytest.approx(sizes[1], abs=1e-3)
    else:
        assert (low, high) == pytest.approx((-abs(20 + 12j) * (1 + 1j), abs(20 + 12j) * (1 + 1j)))
