"""Machines against their mechanisms moved by themselves, against brute force, and against their own parts."""

from collections import Counter
from fractions import Fraction
from functools import cache
from math import lcm
from random import Random

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.machine.shafts import common_period
from geomkin.model.scene import layer_name
from geomkin.studio.edit import answer
from tests.gallery import RECIPES, named, recipe, seen
from tests.texts import parse

TRAIN = 'kind = "gear-train", train = { stages = [[12, 36], [12, 48]], module = 1, directions_deg = [-90, -60] }'
STOCK = "stock = { bore = 3, pin = 0, thickness = 3 }, last_stock = { bore = 2, thickness = 3 }"
PAIR = 'kind = "gear-pair", first = { teeth = 16, module = 2 }, second = { teeth = 24, module = 2 }'
CRANK = 'kind = "slider-crank", linkage = { crank = 20, coupler = 70 }'
CAM = (
    'kind = "disk-cam", cam = { base_radius = 30, direction = "clockwise", follower = { kind = "translating-roller", '
    'roller_radius = 8 }, program = [{ kind = "rise", law = "cycloidal", rise = 12, end_deg = 150 }, '
    '{ kind = "return", law = "cycloidal", end_deg = 360 }] }'
)
PLANETARY = (
    'kind = "planetary", gears = { sun = { teeth = 24, module = 2 }, planet = { teeth = 18, module = 2 }, '
    "ring = { teeth = 60, module = 2, addendum = 0.8 } }, sun_stock = { bore = 8 }, planet_stock = { bore = 4 }"
)


def machine(top="", **mechanisms):
    """A machine from the keys of its mechanisms; those of the recipe inside braces."""
    return 'kind = "machine"\n' + top + "".join(f"[mechanisms.{n}]\n{keys}\n" for n, keys in mechanisms.items())


def inline(keys, more=""):
    return f"recipe = {{ {keys} }}\n{more}"


@cache
def legs(phase=70, angle=25, up=True):
    return parse(
        machine(
            "drive = { speed_rpm = -200 }\n",
            left=f'recipe = "walking-leg.toml"\nturned_by = "train.driven_2"\nupside_down = {str(up).lower()}',
            train=inline(f"{TRAIN}, {STOCK}"),
            right=f'recipe = "walking-leg.toml"\nturned_by = "train.driven_2"\nphase_deg = {phase}\nangle_deg = {angle}',
        ),
        folder=str(RECIPES),
    )


def some(scene):
    return np.linspace(0, len(scene.time) - 1, 7).astype(int)


def test_legs_stand_where_they_stand_when_moved_by_themselves():
    own = legs()
    scene, leg = own.scene, recipe("walking-leg")
    # Both meshes reverse the rotation, and the driver goes clockwise.
    crank = -np.radians(scene.drive.values * -1) * Fraction(12, 36) * Fraction(12, 48)
    shaft = gk.GearTrain(((12, 36), (12, 48)), 1, (-90, -60)).axes[2]
    for name, phase, angle in (("left", 0, 0), ("right", 70, 25)):
        for k in some(scene):
            motion = gk.move(leg.linkage, [float(crank[k]) + np.radians(phase)], leg.made.branch)
            for body in ("crank", "leg"):
                turned = np.exp(1j * np.radians(angle))
                found = named(scene, f"{name}/{body}")
                assert found.origin[k] == pytest.approx(
                    shaft + turned * motion.bodies[body].origin.position[0], abs=1e-9
                )
                assert found.direction[k] == pytest.approx(turned * motion.bodies[body].direction[0], abs=1e-9)


@pytest.mark.campaign
def test_gears_pass_as_many_teeth_as_their_mates_and_do_not_overlap():
    scene = legs().scene
    for one, other, teeth in (("driver_1", "driven_1", (12, 36)), ("driver_2", "driven_2", (12, 48))):
        bodies = [named(scene, f"train/{name}") for name in (one, other)]
        passed = [np.unwrap(np.angle(body.direction)) * z for body, z in zip(bodies, teeth)]
        assert passed[0] - passed[0][0] == pytest.approx(-(passed[1] - passed[1][0]), abs=1e-9)
        assert abs(passed[0][-1] - passed[0][0]) > 20 * np.pi
        for k in some(scene):
            assert seen(bodies[0], k).intersection(seen(bodies[1], k)).area < 1e-3
            assert seen(bodies[0], k).distance(seen(bodies[1], k)) < 0.05
    on_arbor = [np.angle(named(scene, f"train/{name}").direction) for name in ("driven_1", "driver_2")]
    assert np.exp(1j * on_arbor[0]) == pytest.approx(np.exp(1j * on_arbor[1]))


def test_axis_of_a_driver_is_on_its_shaft_wherever_its_own_recipe_has_it():
    keys = 'kind = "slider-crank", linkage = { crank = 20, coupler = 70, origin = [12, -7], ground_angle_deg = 15 }'
    turned = 'turned_by = "a.crank"\nangle_deg = 30'
    scene = parse(machine(a=inline(keys), b=inline(keys, turned))).scene
    for k in some(scene):
        pin, ground = (named(scene, f"b/{name}") for name in ("crank", "ground"))
        assert pin.origin[k] == pytest.approx(12 - 7j) == named(scene, "a/crank").origin[k]
        assert ground.origin[k] == pytest.approx(12 - 7j)
        assert np.angle(ground.direction[k], deg=True) == pytest.approx(45)


def test_scene_returns_after_the_period_and_not_before():
    scene = parse(machine(pair=inline(PAIR), a=inline(CRANK, 'turned_by = "pair.first"'),
                          b=inline(CRANK, 'turned_by = "pair.second"'))).scene  # fmt: skip
    assert scene.cyclic and scene.drive.values[-1] == pytest.approx(3 * 360)
    apart = sum(np.abs(named(scene, f"{n}/crank").direction - named(scene, f"{n}/crank").direction[0]) for n in "ab")
    assert apart[-1] < 1e-9 and (apart[1:-1] > 0.01).all()


@pytest.mark.parametrize(("teeth", "period"), [(16, "1 turn"), (24, "3/2 turns")])
def test_a_period_of_one_turn_is_in_the_singular(teeth, period):
    pair = f'kind = "gear-pair", first = {{ teeth = 16, module = 2 }}, second = {{ teeth = {teeth}, module = 2 }}'
    own = gk.load(machine(pair=inline(pair), crank=inline(CRANK, 'turned_by = "pair.second"\n')))
    assert own.quantities["period"].startswith(f"{period} of") and any(f" {period} of" in fact for fact in own.facts)


def test_period_is_the_least_by_trying_all():
    random = Random(1)
    for _ in range(60):
        speeds = [Fraction(random.randint(1, 9), random.randint(1, 9)) for _ in range(random.randint(1, 3))]
        step, k = Fraction(1, lcm(*(speed.numerator for speed in speeds))), 1
        while any((k * step * speed).denominator > 1 for speed in speeds):
            k += 1
        assert common_period(speeds) == k * step


def test_time_passes_at_the_speed_of_the_driver():
    own = legs()
    assert own.table["driver_angle"][-1] == pytest.approx(-12 * 360)
    assert own.table["time"][-1] == pytest.approx(12 / 200 * 60)
    assert own.table["right_driver_angle"][0] == 70


def test_cam_lifts_its_follower_by_its_programme_at_the_angle_of_its_shaft():
    own = parse(machine(pair=inline(PAIR), lift=inline(CAM, 'turned_by = "pair.second"\nphase_deg = 40')))
    scene, cam = own.scene, own.recipes["lift"].cam
    # The second gear turns clockwise, as the cam counts.
    angle = np.radians(40) + np.radians(scene.drive.values) * 16 / 24
    assert own.table["lift_lift"] == pytest.approx(cam.program.motion(np.remainder(angle, 2 * np.pi)).lift, abs=1e-9)
    shaft = 1j * own.recipes["pair"].design.centre_distance
    assert named(scene, "lift/cam").direction == pytest.approx(np.exp(-1j * angle), abs=1e-9)
    assert named(scene, "lift/roller").origin.real == pytest.approx(np.full(len(angle), shaft.real), abs=1e-9)
    assert named(scene, "lift/roller").origin.imag == pytest.approx(shaft.imag + 38 + own.table["lift_lift"], abs=1e-9)


def test_crank_on_a_carrier_turns_with_it():
    own = parse(machine(set=inline(PLANETARY), pump=inline(CRANK, 'turned_by = "set.carrier"')))
    scene, gears = own.scene, own.recipes["set"].design
    ratio = gears.speeds(sun=1.0, ring=0.0)["carrier"]
    for name in ("set/carrier", "pump/crank"):
        assert named(scene, name).direction == pytest.approx(np.exp(1j * np.radians(scene.drive.values * ratio)))
    _, planets, _ = gears.poses(np.radians(scene.drive.values))
    assert named(scene, "set/planet 1").origin == pytest.approx(planets[0].origin, abs=1e-9)
    assert scene.drive.values[-1] == pytest.approx(360 / ratio)


@pytest.mark.parametrize("name", ["walker", "walking-leg", "shaper", "oldham-coupling", "parallelogram", "roller-cam"])
def test_scene_at_the_recipe_s_own_angles_is_its_scene(name):
    own = recipe(name)
    turn = own.drive.angles if name == "roller-cam" else own.drive.frames - own.drive.frames[0]
    # In another order and some turns later.
    rows = Random(2).sample(range(len(turn)), 20)
    found = own.scene_at(turn[rows] + 14 * np.pi)
    for body in found.bodies:
        same = named(own.scene, body.name)
        assert (body.layer == same.layer and body.parts == same.parts) or "copy" in body.name
        assert body.origin == pytest.approx(same.origin[rows], abs=1e-9)
        assert body.direction == pytest.approx(same.direction[rows], abs=1e-9)


def axes(scene):
    """Axes on which two or more parts have bores that coincide at all frames, as the parts on each."""
    places = []
    for body in scene.bodies:
        for part in body.parts:
            for hole in {complex(hole.centre) for hole in part.holes if isinstance(hole, gk.plane.Circle)}:
                places.append((part.name, body.origin + body.direction * hole))
    found = []
    for name, place in places:
        near = next((axis for axis in found if np.abs(axis[0] - place).max() < 0.3), None)
        if near:
            near[1].add(name)
        else:
            found.append((place, {name}))
    return [names for _, names in found if len(names) > 1]


def count(own, *words):
    return sum(item.count for item in own.bought if any(word in item.name for word in words))


def test_bill_has_one_shaft_or_screw_for_each_axis_of_the_scene():
    own = legs()
    held = axes(own.scene)
    assert {"left_crank", "train_driven_2", "right_crank", "train_base"} < max(held, key=len)
    assert len(held) == count(own, "shaft 2 mm", "shaft 3 mm", "cap screw") == 15
    # One nut and one washer for each screw, and two collars for each shaft.
    assert count(own, "nut") == count(own, "washer") == count(own, "cap screw") == 12
    assert count(own, "collar") == 2 * count(own, "shaft 2 mm", "shaft 3 mm") == 6


def test_shaft_of_a_motor_on_a_crank_is_that_of_the_machine():
    driven = inline(f'{FOUR_BAR}, stock = {{ motor = "nema17" }}')
    own = parse(machine(a=driven, b=inline(FOUR_BAR, 'turned_by = "a.crank"\nangle_deg = 90')))
    # Three pins remain in each mechanism besides the motor's shaft.
    assert len(axes(own.scene)) == count(own, "motor", "head screw ISO 7380", "shaft ") == 7


def test_sun_s_shaft_stays_if_the_carrier_turns_another():
    own = parse(machine(set=inline(PLANETARY),
                        pump=inline(CRANK, 'turned_by = "set.carrier"')))  # fmt: skip
    joints = [joint for item in own.bought for joint in item.joints if "shaft 8" in item.name]
    assert any(joint.startswith("set ") for joint in joints)


def test_first_shaft_of_a_reverted_train_that_turns_another_is_one_shaft():
    """The hour wheel of a clock turns on the shaft of its minute wheel, which goes on to the seconds."""
    clock = 'kind = "gear-train", train = { stages = [[12, 36], [12, 36]], module = 1, arrangement = "reverted" }'
    hours, seconds = (f"{text}, stock = {{ bore = 3, pin = 0 }}" for text in (clock, TRAIN))
    own = parse(machine(hours=inline(hours), seconds=inline(seconds, 'turned_by = "hours.driver_1"')))
    assert len(axes(own.scene)) == count(own, "shaft 3 mm") == 4


def test_parts_are_those_of_the_mechanisms_and_the_shaft_passes_all_its_layers():
    own = legs()
    assert Counter({part.name: part.count for part in own.parts}) == Counter(
        {f"{name}_{part.name}": part.count for name, each in own.recipes.items() for part in each.parts}
    )
    held = {id(part) for body in own.scene.bodies for part in body.parts}
    assert all(id(part) in held for part in own.parts if not part.name.endswith("spacer"))
    # Crank, spacer and ground of each leg, 2.5 mm each, and base and two layers of gears, 3 mm each.
    assert own.shafts[0].length == pytest.approx(6 * 2.5 + 3 * 3)


def test_fits_that_a_mechanism_does_not_state_are_assumed_once_each():
    stated = f"{CRANK}, stock = {{ clearance = 0.15 }}"
    own = parse(machine(a=inline(CRANK), b=inline(stated, 'turned_by = "a.crank"')))
    assert set(own.assumed_fits) == {"files.kerf", "mechanisms.a.recipe.stock.clearance"}


@pytest.mark.campaign
@pytest.mark.parametrize("up", [True, False])
def test_shaft_that_meets_a_moving_plate_is_found(up):
    """Against polygons of all plates between the joined ones, frame by frame."""
    own = legs(up=up)
    layers = [named(own.scene, name).layer for name in ("left/crank", "train/driven_2", "right/crank")]
    axis = shapely.Point(*(lambda z: (z.real, z.imag))(own.shafts[0].axis))
    room = np.inf
    for body in own.scene.bodies:
        if min(layers) <= body.layer <= max(layers) and body.layer not in layers:
            room = min(room, *(seen(body, k).distance(axis) for k in range(0, len(own.scene.time), 4)))
    check = next(check for check in own.design_checks if check.id.endswith("_room"))
    assert check.passed == up
    if not up:
        assert check.value == pytest.approx(room - 1, abs=0.02)


@pytest.mark.campaign
@pytest.mark.parametrize(("directions", "free"), [("[-90, -60]", True), ("[0, 0]", False)])
def test_leg_that_moves_where_the_motor_hangs_is_found(directions, free):
    """The cylinder of the motor against the plates below it, by polygons."""
    stock = "stock = { bore = 3, pin = 0, thickness = 3 }, last_stock = { bore = 2, thickness = 3 }"
    motor = 'first_stock = { bore = 4, bore_form = "D", motor = "25d-75", thickness = 3 }, base = { screw = 3 }'
    train = f"{TRAIN.replace('[-90, -60]', directions)}, {stock}, {motor}"
    leg = 'recipe = "walking-leg.toml"\nturned_by = "train.driven_2"\nupside_down = true'
    own = parse(machine(leg=leg, train=inline(train)), folder="recipes")
    (check,) = (check for check in own.checks if check.id == "motor_room")
    # The axis of the motor is that of the first gear, at the origin of the train, which is in place.
    place = named(own.scene, "train/driver_1").origin[0]
    cylinder = shapely.Point(place.real, place.imag).buffer(12.5, 64)
    least = np.inf
    for body in (body for body in own.scene.bodies if body.name.startswith("leg/")):
        for origin, direction in zip(body.origin[::12], body.direction[::12]):
            for part in body.parts:
                z = origin + direction * gk.flatten(part.outline, 0.01)
                least = min(least, shapely.Polygon(gk.plane.xy(z)).distance(cylinder))
    assert check.passed == free == (least > 0)
    if free:
        assert check.value == pytest.approx(least, abs=0.3)


def test_bores_of_another_diameter_than_the_shaft_fail_a_check():
    other = parse(machine(pair=inline(f"{PAIR}, second_stock = {{ bore = 6 }}, first_stock = {{ bore = 6 }}"),
                          pump=inline(CRANK, 'turned_by = "pair.second"')))  # fmt: skip
    checks = {check.id: check for check in other.design_checks}
    assert checks["pair_second_shaft_bores"].value == pytest.approx(2) and not checks["pair_second_shaft_bores"].passed
    none = parse(machine(pair=inline(PAIR), pump=inline(CRANK, 'turned_by = "pair.second"')))
    assert not {check.id: check for check in none.design_checks}["pair_second_shaft_bores"].passed


def test_recipe_is_written_as_read_and_read_again_from_its_sources():
    own = legs()
    text = gk.recipe.to_toml(own)
    assert parse(text, folder=str(RECIPES)) == own == parse(text, folder=own.sources)
    assert list(own.sources) == ["walking-leg.toml"]


@pytest.mark.campaign
def test_handles_of_mechanisms_are_on_their_pins_and_follow_the_pointer():
    text = machine(pair=inline(PAIR), lift=inline(CAM, 'turned_by = "pair.second"'),
                   wiper=inline(FOUR_BAR, 'turned_by = "pair.second"\nphase_deg = 30\nangle_deg = 200'))  # fmt: skip
    own = parse(text)
    handles = {handle.id: handle for handle in own.handles}
    for id, body in (("wiper/point:crank_pin", "wiper/coupler"), ("lift/point:cam.follower.offset", "lift/roller")):
        assert np.abs(handles[id].at - named(own.scene, body).origin).max() < 0.01
    for id, frame, by in (
        ("wiper/point:rocker_pin", 100, 1 + 2j),
        ("lift/circle:cam.base_radius", 0, 35),
    ):
        handle = handles[id]
        to = handle.at[min(frame, len(handle.at) - 1)] + by
        drag = {"handle": id, "to": [to.real, to.imag], "frame": frame, "step": 0.1}
        changed = answer(text, {}, {"drag": drag})
        assert not changed["problems"] and changed["text"] != text
        moved = next(handle for handle in parse(changed["text"]).handles if handle.id == id)
        away = abs(moved.at[min(frame, len(moved.at) - 1)] - to)
        assert away == pytest.approx(moved.radius, abs=0.6 if moved.radius else 0.1)


@pytest.mark.campaign
def test_a_file_of_lifts_that_changes_is_read_again(tmp_path):
    program = 'program = [{ kind = "table", file = "lift.csv", decimals = 4 }]'
    follower = 'follower = { kind = "translating-roller", roller_radius = 8 }'
    cam = f'kind = "disk-cam", cam = {{ base_radius = 30, {follower}, {program} }}'
    text = machine(pair=inline(PAIR), lift=inline(cam, 'turned_by = "pair.second"'))
    for height in (5, 9):
        lifts = (f"{a},{height / 2 * (1 - np.cos(np.radians(a))):.4f}" for a in range(0, 361, 5))
        (tmp_path / "lift.csv").write_text("\n".join(["cam_angle_deg,lift_mm", *lifts]))
        lift = parse(text, folder=str(tmp_path)).recipes["lift"].table["lift"]
        assert lift.max() == pytest.approx(height, abs=0.01)


def test_goal_is_a_mechanism_too():
    goal = 'kind = "crank-rocker-synthesis", wanted = { swing_deg = 40, time_ratio = 1.1, crank = 30 }'
    own = parse(machine(pair=inline(PAIR), wiper=inline(goal, 'turned_by = "pair.second"')))
    assert any(body.name == "wiper/rocker" for body in own.scene.bodies)


def test_pictures_of_the_layers_have_the_parts_of_the_steps():
    own = legs()
    parts = []
    for name, bodies in own.scene.units.items():
        for body in bodies:
            (step,) = (step for step in own.steps if step.startswith(f"{name}: {layer_name(body.layer)}: "))
            parts += [part.name for part in body.parts]
            assert all(part.name.removeprefix(f"{name}_") in step for part in body.parts)
    assert {*parts} == {part.name for part in own.parts if "spacer" not in part.name}


FOUR_BAR = 'kind = "four-bar", linkage = { ground = 100, crank = 30, coupler = 90, rocker = 70 }'
REFUSED = {
    "one": (machine(a=inline(CRANK)), "mechanisms", "out-of-range"),
    "unknown mechanism": (machine(a=inline(PAIR), b=inline(CRANK, 'turned_by = "c.second"')),
                          "mechanisms.b.turned_by", "unknown-key"),
    "unknown body": (machine(a=inline(PAIR), b=inline(CRANK, 'turned_by = "a.secnod"')),
                     "mechanisms.b.turned_by", "unknown-key"),
    "uneven body": (machine(a=inline(FOUR_BAR), b=inline(CRANK, 'turned_by = "a.rocker"')),
                    "mechanisms.b.turned_by", "unknown-key"),
    "circle": (machine(a=inline(PAIR, 'turned_by = "b.second"'), b=inline(PAIR, 'turned_by = "a.second"')),
               "mechanisms.a.turned_by", "conflict"),
    "itself": (machine(a=inline(PAIR), b=inline(PAIR, 'turned_by = "b.second"')),
               "mechanisms.b.turned_by", "conflict"),
    "never turned": (machine(a=inline(PAIR), b=inline(CRANK)), "mechanisms.b.turned_by", "missing-key"),
    "turned twice": (machine(a=inline(PAIR), b=inline(f'{CRANK}, stock = {{ motor = "nema17" }}',
                                                       'turned_by = "a.second"')),
                     "mechanisms.b.recipe.stock.motor", "conflict"),
    "no whole turn": (machine(a=inline(PAIR), b=inline(f"{CRANK}, drive = {{ end_deg = 90 }}", 'turned_by = "a.second"')),
                      "mechanisms.b.recipe", "conflict"),
    "no driver": (machine(a=inline('kind = "spur-gear", gear = { teeth = 20, module = 2 }'), b=inline(CRANK)),
                  "mechanisms.a.recipe", "conflict"),
    "machine in a machine": (machine(a=inline(PAIR), b=inline('kind = "machine", mechanisms = {}')),
                             "mechanisms.b.recipe.kind", "conflict"),
    "outside": (machine(a=inline(PAIR), b='recipe = "../recipes/four-bar.toml"\nturned_by = "a.second"'),
                "mechanisms.b.recipe", "out-of-range"),
    "no file": (machine(a=inline(PAIR), b='recipe = "none.toml"\nturned_by = "a.second"'),
                "mechanisms.b.recipe.file", "file-unreadable"),
    "wrong key inside": (machine(a=inline(PAIR), b=inline(CRANK.replace("coupler", "cuopler"), 'turned_by = "a.second"')),
                         "mechanisms.b.recipe.linkage.coupler", "missing-key"),
    "no table": (machine(a=inline(PAIR), b='recipe = 3\nturned_by = "a.second"'), "mechanisms.b.recipe", "wrong-type"),
    "workshop of all": ('workshop = "laser.toml"\n' + machine(a=inline(PAIR), b=inline(CRANK, 'turned_by = "a.second"')),
                        "workshop", "conflict"),
    "another kerf": (machine(a=inline(f"{PAIR}, files = {{ kerf = 0.2 }}"), b=inline(CRANK, 'turned_by = "a.second"')),
                     "files.kerf", "conflict"),
    "names alike": (machine(a=inline(PAIR), a_b=inline(CRANK, 'turned_by = "a.second"')), "mechanisms", "conflict"),
    "long period": (machine(a=inline('kind = "gear-train", train = { module = 1, stages = [[13, 37], [13, 41]] }'),
                            b=inline(CRANK, 'turned_by = "a.driver_1"'), c=inline(CRANK, 'turned_by = "a.driven_2"')),
                    "mechanisms", "too-much-work"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_impossible_machine_is_refused_by_key(name):
    text, key, id = REFUSED[name]
    with pytest.raises(gk.RecipeError) as caught:
        parse(text)
    assert [(p.key, p.id) for p in caught.value.problems[:1]] == [(key, id)]


def test_files_that_name_each_other_are_refused(tmp_path):
    for one, other in ("ab", "ba"):
        text = machine(x=f'recipe = "{other}.toml"', y=f'recipe = "{other}.toml"\nturned_by = "x.crank"')
        (tmp_path / f"{one}.toml").write_text(text)
    with pytest.raises(gk.RecipeError, match="machine"):
        gk.load(tmp_path / "a.toml")


def test_name_of_a_part_that_is_too_long_names_the_mechanism():
    name = "x" * 38
    own = parse(machine(a=inline(PAIR), **{name: inline(CRANK, 'turned_by = "a.second"')}))
    with pytest.raises(gk.DesignError) as caught:
        _ = own.parts
    assert caught.value.field == f"mechanisms.{name}"


def test_a_ring_turns_the_carrier_of_a_set_whose_sun_is_held():
    pair = 'kind = "internal-gear-pair", pinion = { teeth = 20, module = 2 }, ring = { teeth = 50, module = 2, addendum = 0.8 }'
    set_ = PLANETARY.replace('kind = "planetary"', 'kind = "planetary", driver = "carrier", fixed = "sun"')
    text = machine(pair=inline(pair, "angle_deg = 30"), set=inline(set_, 'turned_by = "pair.ring"\nupside_down = true'))
    table = parse(text).table
    turned = [np.ptp(table[id]) for id in ("pair_driver_angle", "pair_ring_turn", "set_ring_angle")]
    assert turned[0] / turned[1] == pytest.approx(50 / 20)
    # With the sun held, the ring turns by 1 + sun / ring.
    assert turned[2] / turned[1] == pytest.approx(1 + 24 / 60)


@pytest.mark.parametrize("bore", [4, 5])
def test_a_ring_that_turns_a_crank_needs_a_disc_and_its_shaft_has_the_bore_of_the_crank(bore):
    ring = {"kind": "internal-gear-pair", "pinion": {"teeth": 18, "module": 2}, "ring": {"teeth": 60, "module": 2}}
    crank = {"kind": "slider-crank", "linkage": {"crank": 20, "coupler": 70}, "stock": {"pin_diameter": bore}}
    machine = gk.load({"kind": "machine", "mechanisms": {"pair": {"recipe": ring},
                       "pump": {"recipe": crank, "turned_by": "pair.ring"}}})  # fmt: skip
    (check,) = (check for check in machine.design_checks if check.id == "pair_ring_shaft_bores")
    (shaft,) = machine.shafts
    assert check.passed and shaft.diameter == bore and list(shaft.bores) == ["pump/crank"]
    assert "pair/ring" in shaft.bodies


@pytest.mark.campaign
@pytest.mark.parametrize("changes", [{}, {"mirrored": True, "angle_deg": 30}])
def test_the_handle_of_a_phase_is_dragged_round_its_shaft(changes):
    text = """kind = "machine"
[mechanisms.pair]
recipe = { kind = "gear-pair", first = { teeth = 20, module = 2 }, second = { teeth = 40, module = 2 } }
[mechanisms.crank]
turned_by = "pair.second"
phase_deg = 20
recipe = { kind = "slider-crank", linkage = { crank = 20, coupler = 70 } }
"""
    for key, held in changes.items():
        text = text.replace("phase_deg", f"{key} = {str(held).lower()}\nphase_deg")
    reply = answer(text, {}, {})
    assert not reply["problems"], reply["problems"]
    (handle,) = [handle for handle in reply["handles"] if handle["id"].startswith("phase:")]
    frame = 37
    start, axis = (complex(*(row[frame] if isinstance(row, list) else row for row in handle[name]))
                   for name in ("at", "anchor"))  # fmt: skip
    to = axis + (start - axis) * np.exp(0.5j)
    drag = {"handle": handle["id"], "to": [to.real, to.imag], "frame": frame, "step": 0.1}
    reply = answer(text, {}, {"drag": drag})
    moved = gk.load(reply["text"])
    # Seen from the other side it turns the other way.
    turned = moved.mechanisms["crank"].phase_deg - 20
    assert abs(turned - np.degrees(-0.5 if changes else 0.5)) < 0.3
    # The crank itself turned by as much.
    cranks = [next(body for body in recipe.scene.bodies if body.name == "crank/crank").direction[0]
              for recipe in (gk.load(text), moved)]  # fmt: skip
    assert abs(np.angle(cranks[1] / cranks[0]) - 0.5) < 0.01
