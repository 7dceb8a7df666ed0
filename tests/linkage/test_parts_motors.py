"""A motor at a linkage's crank: the written plates read back, and all that moves looked at round shaft and motor."""

import dataclasses

import ezdxf
import ezdxf.path
import numpy as np
import pytest
import shapely
import shapely.affinity

import geomkin as gk

NAMES = ["crank-rocker", "whitworth", "oldham-coupling"]


def driven(name, **sizes):
    recipe = gk.load(f"recipes/{name}.toml")
    return dataclasses.replace(recipe, stock=dataclasses.replace(recipe.stock, motor="nema17", **sizes))


def read(folder, recipe, name):
    """Outline and holes of a part as written, moved so that the middle of hole 0 is where the part has it."""
    part = next(part for part in recipe.parts if part.name == name)
    gk.write([part], folder / "part.dxf", curves="arcs")
    found = {"CUT": [], "HOLE": []}
    for entity in ezdxf.readfile(folder / "part.dxf").modelspace():
        if entity.dxf.layer in found:
            loop = shapely.Polygon([(p.x, p.y) for p in ezdxf.path.make_path(entity).flattening(1e-4)])
            found[entity.dxf.layer].append(loop)
    return found["CUT"][0], found["HOLE"]


def width(hole):
    return round(hole.bounds[2] - hole.bounds[0], 2)


@pytest.mark.parametrize(
    ("name", "fastener"), [("slider-crank", "screw"), ("whitworth", "rod"), ("oldham-coupling", "screw")]
)
def test_ground_has_the_motor_holes_and_keeps_other_pins_off_the_motor(tmp_path, name, fastener):
    """Boss and screws as makers draw them; other holes keep nuts and washers of 9 mm, or rods, off its square."""
    recipe = driven(name, fastener=fastener)
    plate, holes = read(tmp_path, recipe, "ground")
    (boss,) = [hole for hole in holes if width(hole) == 22.2]
    screws = [hole for hole in holes if width(hole) == 3.4]
    places = np.array([complex(hole.centroid.x, hole.centroid.y) for hole in screws])
    assert np.ptp(places.real) == pytest.approx(31, abs=1e-3) and np.ptp(places.imag) == pytest.approx(31, abs=1e-3)
    middle = complex(boss.centroid.x, boss.centroid.y)
    assert len(screws) == 4 and np.abs(places - middle) == pytest.approx(43.84 / 2, abs=0.005)
    face = shapely.box(middle.real - 21.15, middle.imag - 21.15, middle.real + 21.15, middle.imag + 21.15)
    others = [hole for hole in holes if hole is not boss and all(hole is not screw for screw in screws)]
    # A nut or its washer reaches as far beyond the hole of 4.2 mm.
    beyond = {"screw": (9.0 - 4.2) / 2, "rod": 0.0}[fastener]
    # Its corners are rounded as those of the motor are.
    assert plate.buffer(0.01).contains(face.buffer(-4).buffer(4))
    assert all(hole.distance(face) > beyond - 0.01 and plate.contains(hole) for hole in others)
    ground = next(part for part in recipe.parts if part.name == "ground")
    assert len(ground.hole_names) == len(ground.holes) and sum(map(bool, ground.hole_names)) == len(holes) - 4


@pytest.mark.parametrize(
    ("fit", "play"), [({}, 0.2), ({"fit": "press"}, -0.1), ({"fit": "press", "interference": 0.2}, -0.2)]
)
def test_the_crank_has_the_shaft_s_d_with_its_fit_and_the_flat_faces_its_pin(tmp_path, fit, play):
    plate, holes = read(tmp_path, driven("crank-rocker", **fit), "crank")
    bore, pin = sorted(holes, key=lambda hole: abs(width(hole) - 4.2))[::-1]
    towards = complex(pin.centroid.x - bore.centroid.x, pin.centroid.y - bore.centroid.y)
    turned = shapely.affinity.rotate(bore, -np.degrees(np.angle(towards)))
    left, low, right, high = turned.bounds
    assert (right - left, high - low) == pytest.approx((4.5 + play, 5 + play), abs=3e-3)
    # Seen from the pin the flat is straight: the right side is as long as a chord 2 mm from the axis.
    side = turned.intersection(shapely.box(right - 1e-3, low, right, high)).bounds
    assert side[3] - side[1] == pytest.approx(2 * np.sqrt((2.5 + play / 2) ** 2 - (2 + play / 2) ** 2), abs=0.05)
    assert abs(towards) == pytest.approx(30, abs=0.15) and plate.contains(bore)


def over_pivot(recipe):
    """Plates other than the crank that come over the shaft at some place of the driver, and their layers."""
    motion = gk.move(
        recipe.linkage,
        np.linspace(*np.radians([recipe.drive.start_deg, recipe.drive.end_deg]), 181),
        recipe.made.branch,
    )
    linkage = recipe.linkage.linkage
    pivot = motion.point(linkage.driver_pivot).position
    for part in recipe.parts:
        if part.body and part.name in recipe.made.stack.layers and part.body not in (linkage.driver, linkage.ground):
            body = motion.bodies[part.body]
            seen = ((pivot - body.origin.position) * np.conj(body.direction))[motion.assembled]
            z = gk.flatten(part.outline, 0.05)
            plate = shapely.Polygon(np.column_stack([z.real, z.imag]))
            if (shapely.distance(plate, shapely.points(seen.real, seen.imag)) < 2.5).any():
                yield part.name, recipe.made.stack.layers[part.name]


@pytest.mark.parametrize("name", NAMES)
def test_nothing_passes_through_the_shaft_and_it_is_cut_where_something_passes_over_it(name):
    recipe = driven(name)
    crank = recipe.made.stack.layers[recipe.linkage.linkage.driver]
    passing = dict(over_pivot(recipe))
    assert recipe.made.stack.collisions == () and recipe.made.stack.layers["ground"] == 0
    assert all(layer > crank for layer in passing.values())
    # The motor's shaft is as long as that.
    assert f" {(crank + 1) * recipe.stock.thickness:g} mm " in recipe.bought[0].name


def test_a_crank_so_short_that_its_screw_meets_the_shaft_is_reported():
    """A washer of 9 mm round the crank's pin, and the shaft of 5 mm: they meet below the crank of 6 mm."""
    motion = gk.move(gk.FourBar(100, 6, 90, 70), np.linspace(0, 2 * np.pi, 73))
    stack = gk.linkage.stack_links(motion, gk.linkage.LinkStock(motor="nema17"))
    assert any("shaft" in collision.plate or collision.pin == "crank_pivot" for collision in stack.collisions)
    longer = gk.move(gk.FourBar(100, 12, 90, 70), np.linspace(0, 2 * np.pi, 73))
    assert not gk.linkage.stack_links(longer, gk.linkage.LinkStock(motor="nema17")).collisions


BODIES = {
    "ground": {"O": 0j, "C": 60 + 0j},
    "crank": {"O": 0j, "A": 20 + 0j},
    "arm": {"O": 0j, "B": 70 + 0j},
    "rod": {"A": 0j, "B": 60 + 0j},
}


@pytest.mark.parametrize(
    ("linkage", "sizes", "words"),
    [
        (gk.FourBar(100, 30, 90, 70, driver="coupler"), {}, "coupler"),
        (gk.SliderCrank(30, 90, driver="slider"), {}, "slider"),
        (gk.Linkage(BODIES, "crank"), {}, "arm"),
        (gk.FourBar(24, 8, 22, 18), {"bar_width": 8, "pin_diameter": 3}, "mm"),
    ],
)
def test_what_no_motor_can_turn_is_refused(linkage, sizes, words):
    drive = np.linspace(60, 70, 5) if words.startswith("slider") else np.linspace(0.5, 0.6, 5)
    stock = gk.linkage.LinkStock(motor="nema17", **sizes)
    motion = gk.move(linkage, drive)
    with pytest.raises(gk.DesignError) as caught:
        _ = gk.linkage.link_parts(motion, stock)
    assert caught.value.field == "stock.motor" and words in caught.value.problem


@pytest.mark.parametrize(
    ("sizes", "field", "words"),
    [
        ({"motor": "nema17", "thickness": 1.6}, "motor", "at least 1.65 mm"),
        ({"motor": "nema17", "bar_width": 5.2}, "bar_width", "5.2 mm wide"),
        ({"motor": "nema17", "fit": "press", "interference": 4.5}, "interference", "at most 4.49 mm"),
        ({"fit": "press"}, "fit", "no motor"),
    ],
)
def test_stock_that_holds_no_motor_is_refused(sizes, field, words):
    with pytest.raises(gk.DesignError) as caught:
        gk.linkage.LinkStock(**sizes)
    assert caught.value.field == field and words in f"{caught.value.problem} {caught.value.remedy}"
