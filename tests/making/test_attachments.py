"""What bodies drive: points of named linkages, and the holes, screws and masses of attachments."""

import tomllib

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.recipe.load import from_table
from tests.texts import template_of

FOUR_BAR = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}}
ARM = {"name": "arm", "body": "rocker", "at": [105, 10], "holes": [[-8, 0], [8, 0]]}
HUB = {"name": "hub", "body": "coupler", "at": "bracket", "bolts": 4, "bolt_circle": 20, "bore": 8, "angle_deg": 30}
PAIR = {"kind": "gear-pair", "first": {"teeth": 20, "module": 2}, "second": {"teeth": 40, "module": 2}}


def four_bar(*attachments, points=None, **tables):
    linkage = FOUR_BAR["linkage"] | ({"points": points} if points else {})
    stock = {"attachments": list(attachments), "material": "steel-S235"}
    return from_table({**FOUR_BAR, "linkage": linkage, "stock": stock, **tables})


def part_of(recipe, name):
    return next(part for part in recipe.parts if part.name == name)


def holes_of(part, radius):
    return sorted(
        (h.centre for h in part.holes if isinstance(h, gk.plane.Circle) and abs(h.radius - radius) < 1e-9), key=abs
    )


def polygon(curve):
    return shapely.Polygon(gk.plane.xy(gk.flatten(curve, 1e-4)))


@pytest.mark.parametrize(
    "linkage",
    [
        gk.FourBar(100, 30, 90, 70, points={"rocker": {"tip": 120 + 10j}}),
        gk.Shaper(90, 30, 180, 60, 85, points={"lever": {"tip": 20 + 15j}}),
        gk.WattSixBar(gk.FourBar(100, 30, 90, 70), 50 - 30j, 90, 60, 180 + 0j, points={"output": {"tip": 30 + 9j}}),
        gk.SliderCrank(30, 90, points={"slider": {"tip": 40 + 5j}}),
    ],
    ids=["four-bar", "shaper", "watt", "slider-crank"],
)
def test_a_further_point_moves_with_its_body(linkage):
    ((body, points),) = linkage.points.items()
    motion = gk.move(linkage, np.linspace(0, 6, 25), speed=3.0)
    moved, pose = motion.point("tip"), motion.bodies[body]
    expected = pose.origin.position + pose.direction * points["tip"]
    assert np.allclose(moved.position, expected, equal_nan=True)
    assert np.allclose(moved.velocity, pose.origin.velocity + 1j * pose.omega * pose.direction * points["tip"])


def test_a_load_at_a_further_point_is_that_at_its_coordinates():
    force = {"body": "rocker", "force_n": [0, -5]}
    points = {"rocker": {"tip": [120, 10]}}
    named = four_bar(points=points, loads={"forces": [{**force, "point": "tip"}], "gravity_m_per_s2": [0, 0]})
    by_place = four_bar(points=points, loads={"forces": [{**force, "point": [120, 10]}], "gravity_m_per_s2": [0, 0]})
    assert np.array_equal(named.table["driver_torque"], by_place.table["driver_torque"])


def test_holes_are_in_the_plate_which_extends_to_them_and_screws_are_in_the_bill():
    recipe = four_bar(ARM, HUB, points={"coupler": {"bracket": [45, 30]}})
    rocker, coupler = part_of(recipe, "rocker"), part_of(recipe, "coupler")
    assert holes_of(rocker, 1.6) == pytest.approx([97 + 10j, 113 + 10j])
    assert holes_of(coupler, 4.1) == pytest.approx([45 + 30j])
    circle = np.array(holes_of(coupler, 1.6)) - (45 + 30j)
    assert np.allclose(np.abs(circle), 10) and np.degrees(np.angle(circle) % (np.pi / 2)) == pytest.approx(30)
    for part in (rocker, coupler):
        walls = [polygon(part.outline).exterior.distance(polygon(hole)) for hole in part.holes]
        # The wall of the bars: half of what the pin's hole leaves of their width.
        assert min(walls) > 0.95 * (14 - 4.2) / 2
    bought = {item.name: item.count for item in recipe.bought}
    assert bought["arm"] == bought["hub"] == 1
    assert sum(n for name, n in bought.items() if name.startswith("M3 x")) == 6


def test_the_point_of_an_attachment_has_the_hole_of_the_attachment_only():
    single = {"name": "pen", "body": "coupler", "at": "bracket", "screw": 6}
    coupler = part_of(four_bar(single, points={"coupler": {"bracket": [45, 30]}}), "coupler")
    at_point = [hole.radius for hole in coupler.holes if abs(hole.centre - (45 + 30j)) < 1e-9]
    assert at_point == pytest.approx([3.1])


def test_the_mass_of_an_attachment_is_that_of_its_body():
    light, heavy = (four_bar({**ARM, "mass_kg": kg}).body_masses["rocker"] for kg in (0.0, 0.5))
    assert heavy.mass - light.mass == pytest.approx(0.5)
    moment = heavy.mass * heavy.centre - light.mass * light.centre
    assert moment / 0.5 == pytest.approx(105 + 10j)


def test_a_plate_that_passes_over_an_attachment_fails_the_check():
    def passing(at):
        recipe = four_bar({"name": "pen", "body": "coupler", "at": at})
        return next(check for check in recipe.checks if check.id == "attachments_passed").value

    assert passing([45, 120]) == 0
    assert passing([77, 0]) > 0


def test_copies_have_the_attachments_too():
    copied = four_bar(ARM, copies=[{"phase_deg": 180}])
    assert next(item.count for item in copied.bought if item.name == "arm") == 2


def test_holes_of_a_gear_are_about_its_axis():
    pulley = {"name": "pulley", "bolts": 3, "bolt_circle": 24}
    recipe = from_table({**PAIR, "second_stock": {"bore": 6, "attachments": [pulley]}})
    second = part_of(recipe, "second")
    assert np.abs(holes_of(second, 1.5)) == pytest.approx([12, 12, 12])
    assert len(second.fits) == 4
    assert next(item.count for item in recipe.bought if item.name == "pulley") == 1


HUB_OF_GEAR = {"name": "hub", "bolts": 3, "screw": 2}


@pytest.mark.parametrize(
    ("kind", "stock", "keys", "part", "circle"),
    [
        ("ring-gear", {"stock": {"rim": 10}}, ["attachments"], "ring", 136),
        ("internal-gear-pair", {"ring_stock": {"rim": 10}}, ["attachments"], "ring", 136),
        ("lantern-gears", {"stock": {}}, ["mate_attachments"], "mate", 60),
        ("straight-sided-gears", {"stock": {}}, ["attachments", "mate_attachments"], "gear", 60),
        ("straight-sided-gears", {"stock": {}}, ["mate_attachments"], "mate", 60),
    ],
    ids=["ring", "ring of a pair", "lantern wheel", "gear", "mate"],
)
def test_other_gears_have_attachments_too(kind, stock, keys, part, circle):
    ((key, plain),) = stock.items()

    def made(diameter):
        items = {name: [{**HUB_OF_GEAR, "bolt_circle": diameter}] for name in keys}
        return from_table({**tomllib.loads(template_of(kind)), key: {**plain, "clearance": 0.2, **items}})

    recipe = made(circle)
    assert np.abs(holes_of(part_of(recipe, part), 1.1)) == pytest.approx(3 * [circle / 2])
    assert sum(bought.count for bought in recipe.bought if bought.name == "hub") == len(keys)
    assert any("hub" in step and part in step for step in recipe.steps)
    # No room for them: as far out as the plate goes, in the teeth or the edge of the ring.
    with pytest.raises(gk.DesignError) as caught:
        made(2 * np.abs(gk.flatten(part_of(recipe, part).outline, 0.1)).max()).parts
    assert caught.value.field == f"{key}.{keys[0]}"


def test_holes_of_a_ring_with_a_helix_would_be_twisted():
    pair = {**tomllib.loads(template_of("internal-gear-pair")), "helix_angle_deg": 20}
    items = {"attachments": [{**HUB_OF_GEAR, "bolt_circle": 136}]}
    with pytest.raises(gk.DesignError) as caught:
        from_table({**pair, "ring_stock": {"rim": 10, **items}}).parts
    assert caught.value.field == "ring_stock.attachments"


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"body": "rockr"}, "stock.attachments[0].body"),
        ({"at": "tip"}, "stock.attachments[0].at"),
        ({"bolts": 4}, "stock.attachments[0].bolt_circle"),
        ({"bolt_circle": 20}, "stock.attachments[0].bolts"),
        ({"holes": [[0, 0], [1, 0]]}, "stock.attachments[0]"),
        ({"at": [70, 0], "holes": []}, "rocker"),
    ],
)
def test_impossible_attachments_are_refused_by_key(change, key):
    with pytest.raises((gk.RecipeError, gk.DesignError)) as caught:
        four_bar({**ARM, **change}).parts
    error = caught.value
    assert key == (error.field if isinstance(error, gk.DesignError) else error.problems[0].key)


@pytest.mark.parametrize("points", [{"rockr": {"tip": [1, 2]}}, {"rocker": {"crank_pin": [1, 2]}}])
def test_points_of_no_body_and_names_of_pins_are_refused(points):
    with pytest.raises(gk.RecipeError) as caught:
        four_bar(points=points)
    assert caught.value.problems[0].key.startswith("linkage.points.ro")


def test_holes_in_the_teeth_or_the_bore_of_a_gear_are_refused():
    for circle in (8, 79):
        pulley = {"name": "pulley", "bolts": 3, "bolt_circle": circle}
        recipe = from_table({**PAIR, "second_stock": {"bore": 6, "attachments": [pulley]}})
        with pytest.raises(gk.DesignError) as caught:
            recipe.parts
        assert caught.value.field == "second_stock.attachments"


def test_a_scaled_linkage_has_its_attachment_at_the_scaled_point_with_the_same_screws():
    at_tip = {**ARM, "at": "tip"}
    plain, double = (
        part_of(four_bar(at_tip, points={"rocker": {"tip": [105, 10]}}, scale=scale), "rocker") for scale in (1, 2)
    )
    assert holes_of(plain, 1.6) == pytest.approx([97 + 10j, 113 + 10j])
    assert holes_of(double, 1.6) == pytest.approx([202 + 20j, 218 + 20j])


def test_inches_are_millimetres_times_25_4():
    inches = from_table({
        "kind": "four-bar", "units": "in", "linkage": {"ground": 4, "crank": 1.2, "coupler": 3.6, "rocker": 2.8},
        "stock": {"thickness": 0.125, "bar_width": 0.6, "clearance": 0.008, "pin_diameter": "#8-32",
                  "attachments": [{**ARM, "at": [4.2, 0.4], "holes": [[-0.4, 0], [0.4, 0]], "screw": "#4-40"}]},
    })  # fmt: skip
    holes = holes_of(part_of(inches, "rocker"), 25.4 * (0.112 + 0.008) / 2)
    assert holes == pytest.approx([25.4 * (3.8 + 0.4j), 25.4 * (4.6 + 0.4j)])


@pytest.mark.parametrize("mirrored", [False, True])
def test_holes_of_a_placed_linkage_move_with_its_rocker(mirrored):
    pair = {"kind": "gear-pair", "first": {"teeth": 20, "module": 2}, "second": {"teeth": 40, "module": 2}}
    own = {**FOUR_BAR, "stock": {"attachments": [ARM]}}
    bar = {"recipe": own, "turned_by": "pair.second", "mirrored": mirrored, "angle_deg": 30}
    machine = from_table({"kind": "machine", "mechanisms": {"pair": {"recipe": pair}, "bar": bar}})
    (body,) = (body for body in machine.scene.bodies if body.name == "bar/rocker")
    (hole,) = (hole for hole in body.parts[0].holes if hole.point(0.0) and abs(middle(hole)) > 110)
    seen = body.origin + body.direction * middle(hole)
    # The rocker is where the four-bar alone has it, turned over and moved by the pose of the machine.
    placed = next(mechanism for mechanism in machine.placed if mechanism.name == "bar")
    motion = gk.move(gk.FourBar(100, 30, 90, 70), placed.turn)
    alone = motion.rocker.point(113 + 10j).position
    assert np.allclose(seen, placed.placement.place(alone), atol=1e-6)


def middle(hole):
    points = hole.point(np.linspace(hole.breaks[0], hole.breaks[-1], 5))
    return complex(points[:4].mean())
