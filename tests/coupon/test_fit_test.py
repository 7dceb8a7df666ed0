"""Fit tests: openings measured in the written DXF, walls by shapely, and the range of sizes that is accepted."""

import ezdxf
import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.text import strokes_of

CASES = [
    {"pin": 3},
    {"pin": 6.35, "thickness": 0.8, "step": 0.025, "count": 6},
    {"pin": 0.6, "thickness": 20, "step": 0.02, "count": 25},
    {"pin": 50, "thickness": 6, "step": 1, "count": 5},
]


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"pin {case['pin']}")
def written(request, tmp_path_factory):
    """The recipe and the entities of its DXF."""
    recipe = gk.load({"kind": "fit-test", "openings": request.param})
    path = tmp_path_factory.mktemp("fit") / "coupon.dxf"
    gk.write(recipe, path)
    return recipe, list(ezdxf.readfile(path).modelspace())


def corners(line):
    return np.array([x + 1j * y for x, y, *_ in line.get_points()])


def slots_of(entities):
    """Lower left and upper right corners of the slots from the left, each checked to be a rectangle."""
    slots = []
    for line in (e for e in entities if e.dxf.layer == "HOLE" and e.dxftype() == "LWPOLYLINE"):
        z = corners(line)
        low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
        assert line.closed and len(z) == 4 and not line.has_arc
        assert shapely.box(low.real, low.imag, high.real, high.imag).equals(shapely.Polygon(np.c_[z.real, z.imag]))
        slots.append((low, high))
    return sorted(slots, key=lambda corner: corner[0].real)


def holes_of(entities):
    return sorted((e for e in entities if e.dxftype() == "CIRCLE"), key=lambda hole: hole.dxf.center.x)


def gauge_of(entities):
    """Vertices of the gauge, the outline of least area."""
    return min((corners(e) for e in entities if e.dxf.layer == "CUT"), key=lambda z: np.ptp(z.real) * np.ptp(z.imag))


def test_holes_and_slots_have_their_sizes_in_equal_steps_around_the_nominal_one(written):
    recipe, entities = written
    given = recipe.openings
    for nominal, sizes in (
        (given.pin, [2 * hole.dxf.radius for hole in holes_of(entities)]),
        (given.thickness, [(high - low).real for low, high in slots_of(entities)]),
    ):
        assert len(sizes) == given.count
        assert np.diff(sizes) == pytest.approx(given.step, abs=1e-5)
        assert sizes[given.count // 2] == pytest.approx(nominal, abs=1e-5)
        assert recipe.table["difference"] == pytest.approx(np.array(sizes) - nominal, abs=1e-5)
    assert all(hole.dxf.layer == "HOLE" for hole in holes_of(entities))
    gauge = gauge_of(entities)
    width = min(np.ptp(gauge.real), np.ptp(gauge.imag))
    assert width == pytest.approx(10)
    assert all((high - low).imag > width for low, high in slots_of(entities))


def test_each_opening_is_named_after_its_size_centred_above_it(written):
    """Letters are single strokes, so they are read by comparing them with the strokes of the size measured."""
    _, entities = written
    lines = [corners(e) for e in entities if e.dxf.layer == "ENGRAVE"]
    holes = [(h.dxf.center.x + 1j * (h.dxf.center.y + h.dxf.radius), 2 * h.dxf.radius) for h in holes_of(entities)]
    slots = [(complex((low + high).real / 2, high.imag), (high - low).real) for low, high in slots_of(entities)]
    pitch, names = (holes[1][0] - holes[0][0]).real, []
    for top, size in holes + slots:
        above = [z - top for z in lines if abs((z - top).real).max() < pitch / 2 and abs((z - top).imag - 2).max() < 2]
        name = np.format_float_positional(round(size, 3), trim="-")
        strokes = strokes_of(name)
        assert len(above) == len(strokes)
        width = np.ptp(np.concatenate(above).real)
        for stroke in strokes:
            place = 2.5 * stroke - width / 2 + 0.8j
            assert any(len(z) == len(place) and abs(z - place).max() < 2e-3 for z in above)
        names.append(name)
    half = len(holes)
    assert len(set(names[:half])) == len(set(names[half:])) == half
    assert sum(len(strokes_of(name)) for name in names) == len(lines)


def test_walls_are_those_that_shapely_measures_and_pass(written):
    recipe, entities = written
    rings = [shapely.Point(h.dxf.center.x, h.dxf.center.y).buffer(h.dxf.radius, 256) for h in holes_of(entities)]
    rings += [shapely.box(a.real, a.imag, b.real, b.imag) for a, b in slots_of(entities)]
    outlines = [shapely.Polygon([p[:2] for p in e.get_points()]) for e in entities if e.dxf.layer == "CUT"]
    coupon = max(outlines, key=lambda outline: outline.area)
    assert all(coupon.contains_properly(ring) for ring in rings)
    apart = min(a.distance(b) for k, a in enumerate(rings) for b in rings[:k])
    wall = min(apart, min(coupon.exterior.distance(ring) for ring in rings))
    assert recipe.walls["coupon"] == pytest.approx(wall, abs=1e-2)
    assert all(check.passed for check in recipe.checks if check.id.startswith("wall_"))


def test_gauge_is_drawn_wider_by_the_kerf_and_the_holes_narrower(tmp_path):
    """The reading of docs/making.md: what is cut by a beam of the kerf has the sizes of the recipe."""
    recipe = gk.load({"kind": "fit-test", "openings": {"pin": 3}, "files": {"kerf": 0.2}})
    gk.write(recipe, tmp_path / "coupon.dxf")
    entities = list(ezdxf.readfile(tmp_path / "coupon.dxf").modelspace())
    gauge = gauge_of(entities)
    assert min(np.ptp(gauge.real), np.ptp(gauge.imag)) == pytest.approx(10.2, abs=1e-3)
    assert f"{10.2:g} mm minus" in recipe.steps[0]
    assert [2 * h.dxf.radius for h in holes_of(entities)] == pytest.approx(np.arange(2.6, 3.45, 0.1) - 0.2, abs=1e-5)


def test_values_read_from_the_coupon_reproduce_the_hole_that_fitted(tmp_path):
    """A beam of kerf 0.18 cuts every hole wider by it, in the coupon and in the recipe that names the kerf."""
    kerf, pin, free, pressed = 0.18, 3.0, 2.9, 2.7
    spur = {"kind": "spur-gear", "gear": {"teeth": 24, "module": 2}, "files": {"kerf": kerf}}
    for stock, size in (
        ({"bore": pin, "clearance": free - pin + kerf}, free),
        ({"bore": pin, "fit": "press", "interference": pin - pressed - kerf}, pressed),
    ):
        path = tmp_path / "gear.dxf"
        gk.write(gk.load({**spur, "stock": stock}), path)
        (hole,) = ezdxf.readfile(path).modelspace().query("CIRCLE")
        assert 2 * hole.dxf.radius == pytest.approx(size, abs=1e-5)


def test_range_below_the_pin_is_checked():
    def passed(step, count):
        recipe = gk.load({"kind": "fit-test", "openings": {"pin": 3, "step": step, "count": count}})
        return next(check.passed for check in recipe.checks if check.id == "range_below")

    assert passed(0.1, 7) and passed(0.1, 6) and not passed(0.1, 5) and not passed(0.02, 25)


@pytest.mark.parametrize("size", ["pin", "thickness"])
def test_steps_that_leave_no_opening_are_refused_with_one_that_works(size):
    sizes = {"pin": 3, "thickness": 3, "count": 9} | {size: 0.7}
    with pytest.raises(gk.RecipeError) as refused:
        gk.load({"kind": "fit-test", "openings": {**sizes, "step": 0.2}})
    (problem,) = refused.value.problems
    assert problem.key == "openings.step" and problem.id == "conflict"
    step = float(problem.remedy.split()[-2])
    recipe = gk.load({"kind": "fit-test", "openings": {**sizes, "step": step}})
    assert 0.2 <= min(*recipe.openings.hole_diameters, *recipe.openings.slot_widths) < 0.21


def test_pin_of_the_scene_passes_over_every_hole():
    recipe = gk.load({"kind": "fit-test", "openings": {"pin": 3}})
    (pin,) = recipe.scene.marks
    for hole in recipe.parts[0].holes[:9]:
        frame = int(np.argmin(abs(pin.place - hole.centre)))
        assert abs(pin.place[frame] - hole.centre) < 1e-9
        assert recipe.scene.table["difference"][frame] == pytest.approx(2 * (hole.radius - pin.radius[frame]))
