"""Bores by name: their sizes read back from written drawings, against the standards' tables and polygons of the shaft."""

import ezdxf
import ezdxf.path
import numpy as np
import pytest
import shapely
import shapely.affinity
import trimesh

import geomkin as gk
from geomkin.making.bores import PARALLEL_KEYS, key_of
from tests.cam.cams import CAMS
from tests.campaign import by_default

# As catalogues print it (Flender MD 30.1, and for thin shafts makers of keys, after DIN 6885-1): thickest shaft of a
# range, width of the key, and depth of bore and keyway together, as it is measured.
PRINTED = {
    8: (2, 9.0), 10: (3, 11.4), 12: (4, 13.8), 17: (5, 19.3), 22: (6, 24.8), 30: (8, 33.3), 38: (10, 41.3),
    44: (12, 47.3), 50: (14, 53.8), 58: (16, 62.3), 65: (18, 69.4), 75: (20, 79.9), 85: (22, 90.4), 95: (25, 100.4),
    110: (28, 116.4), 130: (32, 137.4), 150: (36, 158.4), 170: (40, 179.4), 200: (45, 210.4), 230: (50, 241.4),
}  # fmt: skip


def gear(stock, **sizes):
    return gk.gear.SpurGearRecipe(gear=gk.SpurGear(**{"teeth": 24, "module": 2} | sizes), stock=stock)


def written_hole(folder, recipe, curves="arcs", kerf=0.0):
    """The one hole of a gear's drawing: its contour in the file, and about its middle a polygon of it."""
    gk.write(recipe, folder / "gear.dxf", curves=curves, kerf=kerf)
    (contour,) = ezdxf.readfile(folder / "gear.dxf").modelspace().query("*[layer=='HOLE']")
    points = [(p.x, p.y) for p in ezdxf.path.make_path(contour).flattening(1e-4)]
    hole = shapely.Polygon(points)
    return contour, shapely.affinity.translate(hole, *(-np.array(hole.envelope.centroid.coords[0])))


def across(polygon):
    left, low, right, high = polygon.bounds
    return right - left, high - low


@pytest.mark.parametrize("bore", [3, 8])
@pytest.mark.parametrize("fit", [{"clearance": 0.2}, {"fit": "press", "interference": 0.08}])
def test_a_d_bore_is_the_shaft_and_its_fit_all_round(tmp_path, bore, fit):
    play = fit.get("clearance", -fit.get("interference", 0.0))
    _, hole = written_hole(tmp_path, gear(gk.gear.GearStock(bore=bore, bore_form="D", **fit)))
    # Makers draw the flat half a millimetre deep.
    assert across(hole) == pytest.approx((bore + play, bore - 0.5 + play), abs=1e-3)
    shaft = shapely.Point(0, 0).buffer(bore / 2, 2000).intersection(shapely.box(-9, -9, 9, bore / 2 - 0.5))
    assert hole.area == pytest.approx(shaft.buffer(play / 2, join_style="mitre").area, rel=1e-3)


@pytest.mark.parametrize(("form", "flats"), [("square", 4), ("hexagonal", 6)])
@pytest.mark.parametrize("fit", [{"clearance": 0.2}, {"fit": "press", "interference": 0.08}])
@pytest.mark.parametrize("flat", by_default([None, 9.3], [9.3]))
def test_a_bore_with_four_or_six_flats_is_the_shaft_and_its_fit_all_round(tmp_path, form, flats, fit, flat):
    """With sharp corners it has the area n h^2 tan(pi/n); else it is the polygon of the flats within a circle."""
    play = fit.get("clearance", -fit.get("interference", 0.0))
    recipe = gear(gk.gear.GearStock(bore=10, bore_form=form, flat=flat, **fit))
    contour, hole = written_hole(tmp_path, recipe)
    height = ((10 * np.cos(np.pi / flats) if flat is None else flat) + play) / 2
    area = flats * height**2 * np.tan(np.pi / flats)
    corners = height / np.cos(np.pi / flats) * np.exp(1j * np.pi / flats * np.arange(1, 2 * flats, 2))
    # One of the flats is above or below the axis.
    shape = shapely.Polygon(np.c_[(1j * corners).real, (1j * corners).imag])
    if flat is not None:
        radius = (10 + play) / 2
        shape = shape & shapely.Point(0, 0).buffer(radius, 2000)
        half = np.arccos(height / radius)
        area = flats * (height * radius * np.sin(half) + radius**2 * (np.pi / flats - half))
    assert hole.area == pytest.approx(area, rel=1e-5) and hole.symmetric_difference(shape).area < 1e-4 * area
    assert len(contour.get_points()) == flats * (1 if flat is None else 2)
    # What is printed has the same hole.
    gk.write(recipe, tmp_path / "gear.stl")
    solid = trimesh.load(tmp_path / "gear.stl")
    (part,) = recipe.parts
    outline = gk.flatten(part.outline, 1e-4)
    gross = shapely.Polygon(np.c_[outline.real, outline.imag]).area
    assert solid.is_watertight and solid.volume / part.thickness == pytest.approx(gross - area, abs=0.02 * area)


@pytest.mark.parametrize("kerf", [0.0, 0.2])
@pytest.mark.parametrize("sizes", [{"bore": 5, "bore_form": "D"}, {"bore": 12, "bore_form": "keyed"}])
def test_arcs_stay_arcs_whatever_the_kerf_and_the_beam_leaves_the_bore_that_was_asked_for(tmp_path, kerf, sizes):
    recipe = gear(gk.gear.GearStock(**sizes, clearance=0.1))
    contour, hole = written_hole(tmp_path, recipe, kerf=kerf)
    bulges = np.array([b for *_, b in contour.get_points("xyb")])
    radii = [abs(ezdxf.math.bulge_radius(p.vec2, q.vec2, b)) for p, q, b in _edges(contour) if b > 0]
    assert len(bulges) <= 8 and radii == pytest.approx([(sizes["bore"] + 0.1 - kerf) / 2] * len(radii), abs=1e-4)
    _, exact = written_hole(tmp_path, recipe)
    # The beam reaches half its width beyond its path.
    assert hole.buffer(kerf / 2, join_style="mitre").symmetric_difference(exact).area < 2e-3


def _edges(contour):
    points = [(ezdxf.math.Vec3(x, y), b) for x, y, b in contour.get_points("xyb")]
    return [(p, q, b) for (p, b), (q, _) in zip(points, points[1:] + points[:1])]


@pytest.mark.parametrize("thickest", [10, 44, 130])
def test_a_keyed_bore_has_the_standard_s_keyway(tmp_path, thickest):
    stock = gk.gear.GearStock(bore=thickest, bore_form="keyed")
    contour, hole = written_hole(tmp_path, gear(stock, teeth=60, module=6))
    width, measured = PRINTED[thickest]
    assert np.ptp([x for x, *_ in contour.get_points("xyb")]) == pytest.approx(width, abs=1e-4)
    assert across(hole)[1] == pytest.approx(measured, abs=1e-3)


def test_a_shaft_a_little_thicker_takes_the_next_key_and_all_keys_fit_their_two_keyways():
    for key, following in zip(PARALLEL_KEYS, PARALLEL_KEYS[1:]):
        assert key_of(key.thickest) == key and key_of(key.thickest + 0.01) == following
    # Room over the key, which turns by its sides; and no key is wider than a third of its shaft.
    assert all(0.1 < k.shaft_depth + k.hub_depth - k.height < 0.45 for k in PARALLEL_KEYS)
    assert all(k.width <= k.thickest / 3 + 0.5 and k.height <= k.width for k in PARALLEL_KEYS)
    assert key_of(6.0) == PARALLEL_KEYS[0] and key_of(5.99) is None and key_of(231.0) is None


def test_only_the_pressed_bore_is_narrower_than_the_shaft():
    stock = gk.gear.GearStock(bore=8, fit="press", clearance=0.3)
    pair = gk.gear.GearPairRecipe(
        first=gk.SpurGear(20, 2), second=gk.SpurGear(30, 2), first_stock=stock, second_stock=stock
    )
    diameters = {part.name: {2 * hole.radius for hole in part.holes} for part in pair.parts}
    assert diameters == {"first": {7.9}, "second": {7.9}, "base": {8.3}}


def test_a_cam_s_fit_is_that_of_its_bore_and_the_mark_clears_a_flat():
    stock = gk.cam.CamStock(bore=6, bore_form="D", fit="press", interference=0.2, clearance=0.3, timing_mark=True)
    cam = CAMS["roller on arm, clockwise"]
    plates = {part.name: part for part in gk.cam.cam_parts(cam, stock)}
    (hole,) = plates["cam"].holes
    turned = hole.vertices / (cam.profile.point(0.0) / abs(cam.profile.point(0.0)))
    # The flat faces where the follower touches at cam angle 0.
    assert turned.real == pytest.approx([2.4, 2.4]) and np.abs(turned) == pytest.approx([2.9, 2.9])
    assert [2 * h.radius for part in ("roller", "arm") for h in plates[part].holes] == pytest.approx([4.3, 6.3, 4.3])
    assert abs(plates["cam"].marks[0].point(0.0)) > 2.9


REFUSED = [
    ({"bore": 3, "bore_form": "keyed"}, "bore", "6 mm"),
    ({"bore": 300, "bore_form": "keyed"}, "bore", "230 mm"),
    ({"bore": 0, "bore_form": "D"}, "bore", ""),
    ({"bore": 7, "bore_form": "D"}, "bore", "3.5"),
    ({"bore": 5, "bore_form": "D", "flat": 5}, "flat", "2.5"),
    ({"bore": 5, "bore_form": "D", "flat": 2.5}, "flat", "2.5"),
    ({"bore": 5, "flat": 4.5}, "flat", "bore_form"),
    ({"bore": 10, "bore_form": "hexagonal", "flat": 8}, "flat", "8.5736"),
    ({"bore": 10, "bore_form": "square", "flat": 10}, "flat", "less than 10"),
    ({"bore": 5, "bore_form": "D", "keyway_depth": 1}, "keyway_depth", "0"),
    ({"bore": 0.1, "fit": "press"}, "interference", "0.09 mm"),
    ({"bore": 5, "bore_form": "D", "fit": "press", "interference": 4.9}, "interference", "4.49 mm"),
    ({"bore": 0.005, "fit": "press"}, "interference", ""),
]


def test_invalid_bores_are_refused_with_what_works():
    for sizes, field, remedy in REFUSED:
        for stock in (gk.gear.GearStock, gk.cam.CamStock):
            with pytest.raises(gk.DesignError) as caught:
                stock(**sizes)
            assert caught.value.field == field and remedy in caught.value.remedy


@pytest.mark.parametrize("form", ["round", "D", "square", "keyed"])
def test_a_bore_as_wide_as_the_root_is_refused_and_the_one_that_is_named_works(form):
    """Of a pressed bore, too: the rest is reported of the hole, not of the shaft."""
    flat = {"flat": 40} if form == "D" else {}
    stock = {"bore_form": form, "fit": "press", "interference": 0.5, **flat}
    with pytest.raises(gk.DesignError, match="stock.bore") as caught:
        gear(gk.gear.GearStock(bore=60, **stock)).parts
    most = float(caught.value.remedy.split("less than ")[1].split()[0])
    interference = 0.5 / (np.cos(np.pi / 4) if form == "square" else 1.0)
    assert most == pytest.approx(2 * gk.SpurGear(24, 2).root_radius + interference, abs=1e-3)
    if form != "keyed":
        assert gear(gk.gear.GearStock(bore=most - 0.01, **stock)).parts
    with pytest.raises(gk.DesignError, match="stock.bore"):
        gear(gk.gear.GearStock(bore=most + 1e-4, **stock)).parts
