"""The plate of a motor, read back from its drawing, and where it lies in scenes."""

import dataclasses
import tomllib
from pathlib import Path

import ezdxf
import ezdxf.path
import numpy as np
import pytest
import shapely
import shapely.affinity

import geomkin as gk
from geomkin.core.units import Sentence
from geomkin.making.motors import MOTOR_FACES
from geomkin.recipe.load import from_table
from tests.making.test_bases import PAIR, PLANETARY, RACK, cam
from tests.texts import parse, template_of


def test_the_plate_has_the_face_and_holes_that_makers_draw(tmp_path):
    """42.3 mm square, screws 31 mm apart round the boss of 22 mm, which the corners stand 43.84 mm across from."""
    gk.write(gk.making.motor_plate("nema17", thickness=3, clearance=0.2), tmp_path / "plate.dxf")
    drawing = ezdxf.readfile(tmp_path / "plate.dxf").modelspace()
    boss, *screws = sorted(drawing.query("CIRCLE"), key=lambda hole: -hole.dxf.radius)
    places = np.array([complex(*hole.dxf.center.vec2) for hole in screws])
    assert boss.dxf.radius == pytest.approx(11.1) and {hole.dxf.radius for hole in screws} == {1.7}
    offsets = places - complex(*boss.dxf.center.vec2)
    assert (
        np.abs(offsets) == pytest.approx(43.84 / 2, abs=0.005) and len({np.round(np.angle(z), 6) for z in offsets}) == 4
    )
    assert np.ptp(places.real) == np.ptp(places.imag) == pytest.approx(31)
    (outline,) = drawing.query("LWPOLYLINE[layer=='CUT']")
    corners = np.array(outline.get_points("xy"))
    assert np.ptp(corners, axis=0) == pytest.approx([42.3, 42.3])


@pytest.mark.parametrize(
    ("sunk", "name", "longest", "cut"),
    [
        (False, "button head screw ISO 7380-1", 30, "M3 screw, {:g} to {:g} mm under its head"),
        (True, "countersunk screw ISO 7046", 30, "M3 countersunk screw, {:g} to {:g} mm long"),
    ],
)
def test_a_screw_of_a_motor_is_the_longest_that_is_sold_and_reaches_into_it_by_2_to_4_5_mm(sunk, name, longest, cut):
    sold = [length for length in (4, 5, 6, 8, 10, 12, 16, 20, 25, 30) if length >= (4 if sunk else 6)]
    found = set()
    for thickness in np.arange(0.5, 32, 0.5).tolist():
        fits = [length for length in sold if 2 <= length - thickness <= 4.5]
        reported = f"M3 x {fits[-1]} {name}" if fits else cut.format(thickness + 2, thickness + 4.5)
        assert Sentence(MOTOR_FACES["nema17"].screw(thickness, sunk=sunk)) == reported
        found.add(fits[-1] if fits else None)
    assert longest in found and None in found


KINDS = {"spur-gear": "stock", "gear-pair": "first_stock", "rack-and-pinion": "stock", "planetary": "sun_stock",
         "disk-cam": "stock"}  # fmt: skip


@pytest.mark.parametrize("name", ["gear-pair", "planetary", "rocker-cam"])
def test_a_motor_adds_its_plate_below_all_and_changes_nothing_else(name):
    plain = parse(template_of(name)) if name in KINDS else gk.load(f"recipes/{name}.toml")
    key = KINDS.get(name, "stock")
    if getattr(plain, "base", None):
        plain = dataclasses.replace(plain, base=None)
    driven = dataclasses.replace(plain, **{key: dataclasses.replace(getattr(plain, key), motor="nema17")})
    assert sorted(part.name for part in driven.parts) == sorted([*(p.name for p in plain.parts), "motor_plate"])
    motor, *others = driven.scene.bodies
    assert (
        motor.name == "motor" and motor.layer == 0 and not motor.origin.any() and motor.parts[0].name == "motor_plate"
    )
    before = {body.name: body for body in plain.scene.bodies}
    assert [body.name for body in others] == list(before)
    for body in others:
        assert body.layer == before[body.name].layer + 1 > motor.layer
        assert (body.origin == before[body.name].origin).all() and len(body.parts) == len(before[body.name].parts)
    assert any("NEMA 17" in one.name for one in driven.bought) and not any("NEMA" in one.name for one in plain.bought)


# Where a base stands: how it is asked for, the stock of what drives, where its holes for others are, by what the bill
# states of their diameters, and how long the motor's shaft is at least: under a cam lies what carries the roller.
OVER = {
    "pair": (lambda: gk.load(PAIR + "[base]\n"), "first_stock", {10.2: 1, 4.2: 4}, 12),
    "rack": (lambda: gk.load(RACK + "[base]\n"), "stock", {4.2: 4}, 12),
    "planetary": (lambda: gk.load(PLANETARY + "[base]\n"), "sun_stock", {4.2: 10}, 18),
    "arm": (lambda: cam("arm"), "stock", {6.2: 1, 4.2: 4}, 15),
    "straight roller": (lambda: cam("roller"), "stock", {4.2: 4}, 15),
    "small cam": (lambda: cam("undercut"), "stock", {4.2: 4}, 15),
}


def over_a_base(name, **sizes):
    recipe, key, *_ = OVER[name]
    plain = recipe()
    stock = dataclasses.replace(getattr(plain, key), motor="nema17", **{"bore": 5, "bore_form": "D"} | sizes)
    return dataclasses.replace(plain, **{key: stock})


def contours(path, layer):
    """Polygons of all that a drawing has on a layer."""
    for entity in ezdxf.readfile(path).modelspace().query(f"*[layer=='{layer}']"):
        yield shapely.Polygon([(p.x, p.y) for p in ezdxf.path.make_path(entity).flattening(1e-4)])


def square(middle, side):
    return shapely.box(middle.x - side / 2, middle.y - side / 2, middle.x + side / 2, middle.y + side / 2)


def width(hole):
    return round(hole.bounds[2] - hole.bounds[0], 3)


@pytest.mark.parametrize("name", ["rack", "planetary", "arm", "small cam"])
def test_a_base_has_the_motor_s_holes_and_keeps_all_others_off_its_face(tmp_path, name):
    """In the written base: boss and screws as makers draw them, and nothing else within the square of 42.3 mm."""
    _, _, others, _ = OVER[name]
    recipe = over_a_base(name)
    gk.write([part for part in recipe.parts if part.name == "base"], tmp_path / "base.dxf")
    (plate,), holes = contours(tmp_path / "base.dxf", "CUT"), list(contours(tmp_path / "base.dxf", "HOLE"))
    (boss,) = [hole for hole in holes if width(hole) == 22.2]
    screws = [hole for hole in holes if width(hole) == 3.4]
    places = np.array([complex(hole.centroid.x, hole.centroid.y) for hole in screws])
    middle = complex(boss.centroid.x, boss.centroid.y)
    assert len(screws) == 4 and np.abs(places - middle) == pytest.approx(43.84 / 2, abs=0.005)
    assert np.ptp(places.real) == pytest.approx(31, abs=1e-3) and np.ptp(places.imag) == pytest.approx(31, abs=1e-3)
    face = square(boss.centroid, 42.3)
    rest = [hole for hole in holes if hole is not boss and not any(hole is screw for screw in screws)]
    found = {size: sum(width(hole) == size for hole in rest) for size in others}
    assert plate.contains(face) and all(hole.disjoint(face) for hole in rest) and found == others
    # Heads of the base's screws, twice as wide, are clear of the motor, too.
    assert all(hole.centroid.distance(face) >= 4 for hole in rest if width(hole) == 4.2)


SMALL = PAIR.replace("bore = 8", 'bore = 5, motor = "nema17"').replace("module = 3", "module = 1") + "[base]\n"
NEAR = SMALL.replace("module = 1", "module = 1.5")


@pytest.mark.parametrize(
    ("recipe", "field", "words"),
    [
        (lambda: over_a_base("pair", thickness=1.9), "first_stock.motor", "at least 2 mm"),
        (lambda: over_a_base("pair", bore=0, bore_form="round"), "first_stock.bore", "at least 0.01 mm"),
        (lambda: gk.load(SMALL), "first_stock.motor", "mm"),
        # 28.25 mm apart, the hole of 10.2 mm would be clear of the face, but its collar of 20 mm is not.
        (lambda: gk.load(NEAR), "first_stock.motor", "2.9 mm"),
    ],
)
def test_what_would_meet_the_motor_is_refused(recipe, field, words):
    with pytest.raises(gk.DesignError) as caught:
        _ = recipe().parts
    assert caught.value.field == field and words in f"{caught.value.problem} {caught.value.remedy}"


# Face width, spacings of the screws in rising order, boss, shaft, and the distance of the screws' middle from the shaft:
# NEMA ICS 16 and the drawings of the makers.
DRAWN = {
    "nema14": (35.2, [26, 26, 26, 26, 36.77, 36.77], 22, 0),
    "nema23": (56.4, [47.14, 47.14, 47.14, 47.14, 66.67, 66.67], 38.1, 0),
    "28byj-48": (42, [35], 9, 8),
    "25d-75": (25, [17], 7, 0),
    "37d-50": (37, [15.5, 15.5, 15.5, 26.85, 26.85, 31], 12, 13.71),
}


@pytest.mark.parametrize("name", DRAWN)
def test_plates_of_other_motors_are_those_that_makers_draw(name, tmp_path):
    width, spacings, boss, away = DRAWN[name]
    gk.write(gk.making.motor_plate(name, thickness=6, clearance=0.2), tmp_path / "plate.dxf")
    (plate,), holes = contours(tmp_path / "plate.dxf", "CUT"), list(contours(tmp_path / "plate.dxf", "HOLE"))
    opening = max(holes, key=lambda hole: hole.area)
    assert opening.area == pytest.approx(np.pi / 4 * (boss + 0.2) ** 2, rel=1e-3)
    places = np.array([complex(hole.centroid.x, hole.centroid.y) for hole in holes if hole is not opening])
    apart = sorted(abs(a - b) for k, a in enumerate(places) for b in places[:k])
    assert apart == pytest.approx(spacings, abs=0.01)
    axis = complex(opening.centroid.x, opening.centroid.y)
    assert abs(places.mean() - axis) == pytest.approx(away, abs=0.01)
    assert plate.bounds[2] - plate.bounds[0] == pytest.approx(width, abs=1e-3)
    assert all(plate.contains(hole) for hole in holes)


def crank(tmp_path, **stock):
    """Openings of the ground and of the crank of a driven crank-rocker, as drawn."""
    sizes = {"thickness": 6, "bar_width": 20, "pin_diameter": 4, "clearance": 0.2}
    linkage = {"ground": 120, "crank": 40, "coupler": 100, "rocker": 80}
    recipe = gk.load({"kind": "four-bar", "linkage": linkage, "stock": {**sizes, **stock}})
    for name in ("ground", "crank"):
        gk.write([part for part in recipe.parts if part.name == name], tmp_path / f"{name}.dxf")
        yield list(contours(tmp_path / f"{name}.dxf", "HOLE"))
    yield recipe


def test_a_gear_motor_turns_a_crank_by_its_d_shaft(tmp_path):
    ground, on_crank, recipe = crank(tmp_path, motor="37d-30")
    assert sorted(width(hole) for hole in ground) == pytest.approx([3.4, 3.4, 3.4, 3.4, 4.2, 12.2], abs=2e-3)
    (bore,) = [hole for hole in on_crank if hole.area > 20]
    # 6.2 mm round, and 5.7 mm from the flat to the round side.
    left, low, right, high = bore.bounds
    assert sorted([right - left, high - low]) == pytest.approx([5.7, 6.2], abs=2e-3)
    bought = {item.name: item.count for item in recipe.bought}
    assert bought["M3 x 8 countersunk screw ISO 7046"] == 4 and any("37 mm gear motor 30:1" in name for name in bought)


def test_a_flanged_motor_has_nuts_and_a_opening(tmp_path):
    ground, on_crank, recipe = crank(tmp_path, motor="nema23")
    assert sorted(width(hole) for hole in ground) == pytest.approx([4.2, 4.5, 4.5, 4.5, 4.5, 38.3], abs=2e-3)
    assert sorted(width(hole) for hole in on_crank) == pytest.approx([4.2, 6.55], abs=2e-3)
    # Four for the motor, and one for each of the three other joints.
    assert {item.name: item.count for item in recipe.bought}["M4 lock nut ISO 7040"] == 4 + 3


@pytest.mark.parametrize(("fit", "play"), [("running", 0.2), ("press", -0.1)])
def test_a_shaft_with_two_flats_has_a_bore_of_its_form(fit, play, tmp_path):
    _, on_crank, recipe = crank(tmp_path, motor="28byj-48", fit=fit)
    (bore,) = [hole for hole in on_crank if abs(width(hole) - hole.bounds[3] + hole.bounds[1]) > 1]
    radius, half = (5 + play) / 2, (3 + play) / 2
    # The crank lies along x, and so do the directions that its flats face.
    shape = shapely.Point(0, 0).buffer(radius, quad_segs=900) & shapely.box(-half, -9, half, 9)
    placed = shapely.affinity.translate(shape, bore.centroid.x, bore.centroid.y)
    turned = shapely.affinity.rotate(placed, 90)
    assert min((bore ^ placed).area, (bore ^ turned).area) < 2e-3 * shape.area
    assert any("two flats 3 mm apart" in item.name for item in recipe.bought)


@pytest.mark.parametrize(("sizes", "field"), [({}, "flat"), ({"flat": 5}, "flat"), ({"flat": 0}, "flat")])
def test_a_bore_with_two_flats_needs_their_distance(sizes, field):
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.GearStock(bore=5, bore_form="double-D", **sizes)
    assert caught.value.field == field
    assert gk.gear.GearStock(bore=5, bore_form="double-D", motor="28byj-48").across_flat == 3


OWN = {
    "product": "own", "face_width": 30, "screws": [[12, 0], [-12, 0]], "boss_diameter": 10, "boss_height": 1,
    "shaft": 5.4, "flat": 3.7,
}  # fmt: skip


def test_a_motor_is_given_by_its_values(tmp_path):
    ground, on_crank, recipe = crank(tmp_path, motor=OWN)
    assert sorted(width(hole) for hole in ground) == pytest.approx([3.4, 3.4, 4.2, 10.2], abs=2e-3)
    (bore,) = [hole for hole in on_crank if hole.area > 15]
    left, low, right, high = bore.bounds
    assert min(right - left, high - low) == pytest.approx(3.9, abs=2e-3)
    assert gk.load(gk.recipe.to_toml(recipe)) == recipe
    named = next(iter(list(crank(tmp_path, motor="nema14"))[2:]))
    assert named.stock.motor == "nema14" and gk.load(gk.recipe.to_toml(named)) == named


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"boss_height": 30}, "stock.motor"),
        ({"boss_diameter": 5}, "stock.motor.boss_diameter"),
        ({"flat": 2.6}, "stock.motor.flat"),
        ({"thread": 3.5}, "stock.motor.thread"),
        ({"screws": [[12, 0]]}, "stock.motor.screws"),
        ({"screws": [[12, 0], [6, 0]]}, "stock.motor.screws"),
        ({"least_depth": 5}, "stock.motor.least_depth"),
    ],
)
def test_motors_that_cannot_be_mounted_are_refused(changes, field, tmp_path):
    with pytest.raises(gk.RecipeError) as caught:
        list(crank(tmp_path, motor={**OWN, **changes}))
    assert caught.value.problems[0].key == field


def test_the_error_for_an_unlisted_motor_names_the_values_that_suffice():
    values = {"product": "TT", "face_width": 40, "screws": [[-13, 8.75], [-13, -8.75]], "boss_diameter": 7,
              "boss_height": 0, "shaft": 5.4}  # fmt: skip
    recipe = tomllib.loads(Path("recipes/motor-crank.toml").read_text())
    with pytest.raises(gk.RecipeError) as error:
        gk.load(recipe | {"stock": recipe["stock"] | {"motor": "tt"}})
    named = str(error.value).split("values ")[-1].split(", ")
    assert sorted(named) == sorted(values)
    assert gk.load(recipe | {"stock": recipe["stock"] | {"motor": values}}).parts
    for name in named:
        lacking = {key: value for key, value in values.items() if key != name}
        with pytest.raises(gk.RecipeError, match=name):
            gk.load(recipe | {"stock": recipe["stock"] | {"motor": lacking}})


def engagement(recipe):
    return next(check.value for check in recipe.design_checks if check.id == "shaft_engagement")


def turned(kind, **stock):
    tables = {
        "four-bar": {"linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70}},
        "spur-gear": {"gear": {"teeth": 30, "module": 2}},
    }
    return from_table({"kind": kind, **tables[kind], "stock": {"motor": "25d-75", **stock}})


def height_of_crank(recipe):
    layers = recipe.notes["stack"]["layers"]
    return recipe.stock.thickness * next(k for k, names in enumerate(layers) if "crank" in names)


# The shaft of 4 mm ends 12.5 mm above the motor's face.
@pytest.mark.parametrize("thickness", [3, 4, 5, 6, 8])
def test_a_crank_engages_the_shaft_as_far_as_that_reaches(thickness):
    recipe = turned("four-bar", thickness=thickness)
    assert engagement(recipe) == pytest.approx(max(0, min(thickness, 12.5 - height_of_crank(recipe))) / 4)


def test_a_gear_is_above_the_plate_of_its_motor_and_a_shaft_of_unknown_length_is_long_enough():
    assert engagement(turned("spur-gear", thickness=5, bore=4, bore_form="D")) == pytest.approx(5 / 4)
    # The plate, and 2 mm for the heads of its screws.
    assert engagement(turned("spur-gear", thickness=7, bore=4, bore_form="D")) == pytest.approx((12.5 - 7 - 2) / 4)
    assert engagement(turned("four-bar", thickness=3, motor="nema17")) == pytest.approx(3 / 5)


def test_a_hub_with_a_set_screw_engages_the_shaft_too():
    hub = {"name": "hub", "thickness": 2, "bolts": 4, "bolt_circle": 16, "set_screw": True, "body": "crank"}
    found = {
        at: engagement(turned("four-bar", thickness=3, bar_width=24, motor="nema17", attachments=[{**hub, "at": at}]))
        for at in ("crank_pivot", "crank_pin")
    }
    assert found == pytest.approx({"crank_pivot": 5 / 5, "crank_pin": 3 / 5})
