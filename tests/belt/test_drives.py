"""Belt and chain drives: makers' lengths and diameters, strings round discs, rollers and teeth laid into the gaps."""

import re
import tomllib

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.belt.profiles import BELTS, CHAINS
from geomkin.core.errors import RecipeError
from geomkin.recipe.load import from_table
from geomkin.recipe.search import NOT_OFFERED
from tests.gallery import marks, named, recipe, seen
from tests.texts import template_of

GALLERY = ["belt-drive", "chain-drive"]


def wheel(centre, teeth, pitch=2.0, **given):
    return gk.belt.LoopWheel(centre, teeth * pitch / (2 * np.pi), teeth, **given)


def idler(centre, radius, pitch=2.0, **given):
    return gk.belt.LoopWheel(centre, radius, 2 * np.pi * radius / pitch, **given)


def loop(*wheels, pitch=2.0):
    return gk.belt.BeltLoop(wheels, pitch)


def polygon(z):
    return shapely.Polygon(np.column_stack([z.real, z.imag]))


def outline(name, teeth):
    return polygon(gk.flatten(gk.belt.toothed_outline(name, teeth), 1e-4))


def disc(z, radius):
    return shapely.Point(z.real, z.imag).buffer(radius, 400)


def drive(*pulleys, kind="belt-drive", **given):
    return from_table({"kind": kind, {"belt-drive": "pulleys"}.get(kind, "sprockets"): list(pulleys), **given})


# GT2, as makers' calculators print them.
@pytest.mark.parametrize(("second", "teeth"), [(60, 140.811669871759), (40, 260.405 / 2)])
def test_length_of_a_belt_is_the_makers(second, teeth):
    assert loop(wheel(0, 20), wheel(100, second)).length == pytest.approx(teeth, abs=3e-4)


def test_centre_distance_for_a_stock_belt_is_the_makers():
    moved = loop(wheel(0, 20), wheel(100j, 60)).fitted(140)
    apart, near, far = abs(moved.wheels[1].centre), 20 / np.pi, 60 / np.pi
    incline = np.arcsin((far - near) / apart)
    length = 2 * apart * np.cos(incline) + np.pi * (far + near) + 2 * incline * (far - near)
    assert apart == pytest.approx(99.1816, abs=5e-5) and length == pytest.approx(280)
    assert moved.length == pytest.approx(140, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_a_loop_round_wheels_inside_is_the_hull_of_their_discs(seed):
    random = np.random.default_rng(seed)
    angles = np.sort(random.uniform(0, 2 * np.pi / 5, 5)) + 2 * np.pi / 5 * np.arange(5)
    own = loop(*(idler(100 * np.exp(1j * a), r) for a, r in zip(angles, random.uniform(5, 20, 5))))
    hull = shapely.union_all([disc(w.centre, w.radius) for w in own.wheels]).convex_hull
    assert 2 * own.length == pytest.approx(hull.length, rel=1e-5)
    assert polygon(gk.flatten(own.path(), 1e-3)).symmetric_difference(hull).area < 1e-4 * hull.area


WITH_IDLERS = loop(wheel(0, 20), wheel(150 - 40j, 60), wheel(130 + 80j, 40), idler(60 + 30j, 8, is_outside=True))


def test_a_loop_with_an_idler_outside_touches_each_wheel_on_its_side():
    z = gk.flatten(WITH_IDLERS.path(), 1e-4)
    inner, border = polygon(z), shapely.LinearRing(np.column_stack([z.real, z.imag]))
    for w in WITH_IDLERS.wheels:
        assert border.distance(shapely.Point(w.centre.real, w.centre.imag)) == pytest.approx(w.radius, abs=1e-3)
        assert inner.contains(shapely.Point(w.centre.real, w.centre.imag)) != w.is_outside
    assert 2 * WITH_IDLERS.length == pytest.approx(border.length, rel=1e-6)


def test_points_of_a_loop_go_evenly_along_its_directions():
    at = np.linspace(0, WITH_IDLERS.length, 200_001)
    z, direction = WITH_IDLERS.place(at)
    step = np.diff(z)
    assert np.abs(step).sum() == pytest.approx(2 * WITH_IDLERS.length, rel=1e-9)
    assert np.abs(step / np.abs(step) - direction[:-1]).max() < 1e-3
    assert z[-1] == pytest.approx(z[0])


def test_the_outside_of_a_loop_is_everywhere_as_far_from_it():
    pitch_line, back = (polygon(gk.flatten(WITH_IDLERS.path(h), 1e-4)) for h in (0, 1.5))
    assert back.symmetric_difference(pitch_line.buffer(1.5, 400)).area < 1e-5 * back.area


def test_last_wheel_moves_on_its_line_to_the_nearest_place():
    moved = WITH_IDLERS.fitted(258)
    assert moved.length == pytest.approx(258, abs=1e-9)
    centre, given = moved.wheels[-1].centre, WITH_IDLERS.wheels[-1].centre
    assert (centre * np.conj(given)).imag == pytest.approx(0, abs=1e-9)
    others = np.linspace(abs(given), abs(centre), 50)[:-1] * given / abs(given)
    lengths = [loop(*WITH_IDLERS.wheels[:-1], idler(z, 8, is_outside=True)).length for z in others]
    assert np.ptp(np.sign(np.array(lengths) - 258)) == 0


# Outer diameters that makers print, XL and T5 from 10 teeth up.
@pytest.mark.parametrize(
    ("name", "teeth", "diameter", "play"),
    [("GT2-2M", 20, 12.22, 0.005), ("GT2-2M", 80, 50.42, 0.005), ("XL", 10, 15.66, 0.005), ("T5", 20, 31.0, 0.03)],
)
def test_outer_diameter_is_the_makers(name, teeth, diameter, play):
    assert 2 * np.abs(gk.flatten(gk.belt.toothed_outline(name, teeth), 1e-4)).max() == pytest.approx(diameter, abs=play)


def width_at(shape, height):
    """Width of the gap on +y at a height above the axis, mm."""
    line = shapely.LineString([(0, height), (3e3, height)])
    return 2 * line.intersection(shape).bounds[0]


# Depth, and width at a height above the bottom, from the tool drawings and tables.
GROOVES = [
    ("HTD-3M", 1.28, 0.37 + 0.91, None), ("GT2-2M", 0.75, 0.75 - 0.195, 2 * (np.sqrt(1 - 0.195**2) - 0.40)),
    ("GT2-3M", 1.14, 1.14 - 0.29, 2 * (np.sqrt(1.52**2 - 0.29**2) - 0.61)),
    ("HTD-5M", 2.16, 1.56, 3.12), ("XL", 1.65, 1.0, 1.32 + 2 * np.tan(np.radians(25))),
    ("MXL", 0.69, 0.5, 0.84 + 2 * 0.5 * np.tan(np.radians(20))), ("T10", 3.4, 3.4, 6.57),
]  # fmt: skip


@pytest.mark.parametrize(("name", "depth", "height", "width"), GROOVES)
def test_groove_has_the_published_depth_and_width(name, depth, height, width):
    shape, tip = outline(name, 72), BELTS[name].tip_radius(72)
    bottom = shapely.LineString([(0, 0), (0, 1e3)]).intersection(shape).length
    assert tip - bottom == pytest.approx(depth, abs=1e-3)
    # The tips of T are a circle, whose edge is a little below the height of the tips on the groove's middle.
    slack = 0.15 if name == "T10" else 0.02
    assert width is None or width_at(shape, bottom + height * (1 - 0.02 * (name == "T10"))) == pytest.approx(
        width, abs=slack
    )


@pytest.mark.parametrize("name", [*CHAINS, "GT2-2M", "GT2-3M", "HTD-3M", "HTD-5M", "HTD-8M"])
def test_arcs_of_a_gap_are_tangent(name):
    curve = gk.belt.toothed_outline(name, 19)
    joints = curve.breaks[1:-1]
    turning = np.degrees(np.abs(np.angle(curve.velocity(joints) / curve.velocity(joints - 1e-9))))
    # Sprockets have corners at their tips only, two for each tooth, the rounded tips of pulleys none.
    assert np.count_nonzero(turning > 0.01) == (2 * 19 - 1 if name in CHAINS else 0)


@pytest.mark.parametrize("name", [*BELTS, *CHAINS])
def test_teeth_have_tips_and_outlines_do_not_cross(name):
    profile = {**BELTS, **CHAINS}[name]
    for teeth in (profile.fewest_teeth, 20, 21, 60, 150):
        shape = outline(name, teeth)
        assert shape.is_valid and 0 < profile.land(teeth) < profile.pitch
        assert np.hypot(*np.array(shape.exterior.coords).T).max() == pytest.approx(profile.tip_radius(teeth), abs=1e-6)


@pytest.mark.parametrize("name", CHAINS)
@pytest.mark.parametrize("teeth", [9, 17, 60])
def test_a_roller_swings_off_its_sprocket_freely(name, teeth):
    """About the roller before it, which is seated; the least gap is that of the seat."""
    profile, shape = CHAINS[name], outline(name, teeth)
    seat = 1j * profile.pitch_radius(teeth)
    link = seat * np.exp(2j * np.pi / teeth) - seat
    swing = seat + link * np.exp(-1j * np.radians(np.arange(0, 80, 1)))
    gaps = shapely.distance(shapely.points(swing.real, swing.imag), shape) - profile.roller / 2
    assert gaps.min() > 0.005 * profile.roller + 0.01 and gaps[0] < 0.012 * profile.roller + 0.06


@pytest.mark.parametrize("name", GALLERY)
def test_wheels_turn_as_the_loop_passes_them(name):
    own = recipe(name)
    scene, design = own.scene, own.design
    travel = np.radians(scene.drive.values) * design.wheels[0].radius
    for item, axis in zip(design.wheels, design.axes):
        body = named(scene, item.name)
        turn = np.unwrap(np.angle(body.direction))
        side = -1 if item.is_outside else 1
        teeth_or_length = item.teeth * design.profile.pitch / (2 * np.pi) if item.teeth else item.radius
        first = design.wheels[0].teeth * design.profile.pitch / (2 * np.pi)
        assert turn - turn[0] == pytest.approx(side * travel * first / design.wheels[0].radius / teeth_or_length)
        assert np.abs(body.origin - axis).max() == 0


def test_rollers_lie_in_the_gaps_of_all_sprockets():
    own = recipe("chain-drive")
    scene = own.scene
    rollers = marks(scene, "circle")
    seated = 0
    for frame in (0, 7, 40, 111):
        for item in own.design.wheels:
            shape, axis = seen(named(scene, item.name), frame), own.design.axes[own.design.toothed[item.name]]
            for roller in rollers:
                z = roller.place[frame]
                gap = shape.exterior.distance(shapely.Point(z.real, z.imag)) - roller.radius[frame]
                if abs(abs(z - axis) - item.radius) < 1e-9 * item.radius:
                    assert -1e-3 < gap < 0.1
                    seated += 1
    assert seated > 10


def test_teeth_of_the_belt_point_into_the_middle_of_grooves():
    own = recipe("belt-drive")
    scene, seated = own.scene, 0
    for frame in (0, 5, 40, 111):
        for item in own.design.wheels:
            if not item.teeth:
                continue
            body, k = named(scene, item.name), own.design.toothed[item.name]
            for tooth in marks(scene, "line"):
                z = tooth.place[frame] - own.design.axes[k]
                if abs(abs(z) - item.radius) < 1e-9 * item.radius:
                    pitches = np.angle(z / body.direction[frame] / 1j) * item.teeth / (2 * np.pi)
                    assert pitches == pytest.approx(round(pitches), abs=1e-6)
                    assert (tooth.vector[frame] / z).real < 0
                    seated += 1
    assert seated > 10


@pytest.mark.parametrize("name", GALLERY)
def test_forces_on_each_wheel_and_on_all_are_in_balance(name):
    own = recipe(name)
    tensions, design = own.aspect("loads").tensions, own.design
    strands, after = design.loop.strands, tensions.tensions
    before = np.roll(after, 1)
    for k, (item, axis) in enumerate(zip(design.wheels, design.axes)):
        # Each strand pulls on the wheel, along itself and away from it.
        arms = strands[k, 0] - axis, strands[k - 1, 1] - axis
        forces = after[k] * design.loop.directions[k], -before[k] * design.loop.directions[k - 1]
        moment = sum((np.conj(arm) * force).imag for arm, force in zip(arms, forces))
        side = -1 if item.is_outside else 1
        wanted = tensions.torques[k] if k else -tensions.driver_torque
        # A chain pulls on average at the radius of its mean speed, a little inside the pitch circle.
        assert side * moment == pytest.approx(wanted, abs=1e-9, rel=1e-9 if name == "belt-drive" else 0.02)
        assert sum(forces) == pytest.approx(tensions.shaft_loads[k])
    assert abs(tensions.shaft_loads.sum()) < 1e-9


def test_power_of_the_driver_is_that_of_the_driven_wheels():
    own = recipe("chain-drive")
    speeds = [abs(float(own.design.speed(name))) for name in own.design.toothed]
    tensions = own.aspect("loads").tensions
    assert np.dot(speeds, tensions.torques) == pytest.approx(tensions.driver_torque)


@pytest.mark.parametrize("slack", [{}, {"slack_tension_n": 5}])
def test_allowed_tension_is_kept_by_the_advised_torques(slack):
    def tension(torque):
        loads = {"torques_n_mm": [torque], "allowed_tension_n": 20, **slack}
        own = drive({"teeth": 24}, {"teeth": 48, "at": [100, 0]}, loads=loads)
        return next(check for check in own.design_checks if check.id == "tension")

    failed = tension(500)
    assert not failed.passed
    check = tension(float(failed.advice.split("[")[1].split("]")[0]))
    assert check.passed and check.value == pytest.approx(20, rel=1e-3)


def test_machine_turns_by_belt_then_chain():
    """A belt from 24 to 60 teeth and a chain from 17 to 34, placed on one shaft, turned and upside down."""
    belt = {"kind": "belt-drive", "pulleys": [{"teeth": 24}, {"teeth": 60, "at": [100, 20]}]}
    chain = {"kind": "chain-drive", "sprockets": [{"teeth": 17}, {"teeth": 34, "at": [150, 0]}],
             "loads": {"torques_n_mm": [1000]}}  # fmt: skip
    placed = {"recipe": chain, "turned_by": "belt.pulley_2", "angle_deg": 70, "upside_down": True}
    machine = from_table({"kind": "machine", "mechanisms": {"belt": {"recipe": belt}, "chain": placed}})
    last, driver = (named(machine.scene, name) for name in ("chain/sprocket_2", "belt/driver"))
    turns = [np.unwrap(np.angle(body.direction)) for body in (last, driver)]
    assert turns[0] - turns[0][0] == pytest.approx((turns[1] - turns[1][0]) * 24 / 60 * 17 / 34)
    shaft = machine.recipes["belt"].design.axes[1]
    along = machine.recipes["chain"].design.axes[1] * np.exp(1j * np.radians(70))
    assert last.origin[0] == pytest.approx(shaft + along)
    assert machine.table["input_torque"] == pytest.approx(1000 * 24 / 60 * 17 / 34)
    assert all(check.passed for check in machine.design_checks)


@pytest.mark.parametrize("place", [[0, 26], [40, 22]])
def test_distance_of_what_meets_is_that_of_polygons(place):
    """The last wheel is nearest to another wheel, or to a strand that passes it."""
    own = drive({"teeth": 24}, {"teeth": 60, "at": [90, 0]}, {"teeth": 20, "at": place})
    (room,) = (check.value for check in own.design_checks if check.id == "room")
    flange = own.stock.flange_height
    discs = [
        disc(z, max(w.solid_radius + flange, w.radius + own.profile.back))
        for z, w in zip(own.design.axes, own.design.wheels)
    ]
    apart = [a.distance(b) for k, a in enumerate(discs) for b in discs[:k]]
    strands = own.design.loop.strands
    half = max(own.profile.back, own.profile.front)
    for k, (start, end) in enumerate(strands):
        line = shapely.LineString([(start.real, start.imag), (end.real, end.imag)])
        apart += [line.distance(discs[j]) - half for j in range(3) if j not in (k, (k + 1) % 3)]
    assert room == pytest.approx(min(apart), abs=1e-3)


TWO = {"teeth": 24}, {"teeth": 60, "at": [100, 0]}
REFUSED = {
    "pulleys[0].teeth": ({"teeth": 8}, TWO[1]),
    "pulleys[1].at": (TWO[0], {"teeth": 60, "at": [5, 0]}),
    "pulleys[1].side": (TWO[0], {**TWO[1], "side": "outside"}),
    "pulleys[0]": ({"diameter": 20}, TWO[1]),
    "pulleys[2].teeth": (*TWO, {"at": [50, 40]}),
    "pulleys": (*TWO, {"diameter": 10, "at": [50, 0]}),
}


@pytest.mark.parametrize("key", REFUSED)
def test_refused_pulleys_are_named(key):
    with pytest.raises(RecipeError) as caught:
        drive(*REFUSED[key])
    assert [problem.key for problem in caught.value.problems] == [key]


SHORT = {
    "belt.teeth": ({"teeth": 24}, {"teeth": 40, "at": [100, 0]}),
    "chain.links": ({"teeth": 17}, {"teeth": 38, "at": [200, 0]}),
}


@pytest.mark.parametrize(("key", "count"), [("belt.teeth", 40), ("chain.links", 40), ("chain.links", 71)])
def test_too_short_a_loop_names_one_that_fits(key, count):
    loop_name, _, count_name = key.partition(".")
    kind, wheels = f"{loop_name}-drive", SHORT[key]
    with pytest.raises(RecipeError) as caught:
        drive(*wheels, kind=kind, **{loop_name: {count_name: count}})
    (problem,) = caught.value.problems
    assert problem.key == key
    own = drive(*wheels, kind=kind, **{loop_name: {count_name: int(problem.value)}})
    assert own.design.count == problem.value
    assert all(check.passed for check in own.checks if check.id == "room")
    if not count % own.count_step:
        with pytest.raises(RecipeError):
            drive(*wheels, kind=kind, **{loop_name: {count_name: int(problem.value) - own.count_step}})


def test_wheels_that_meet_are_given_the_nearest_place():
    with pytest.raises(RecipeError) as caught:
        drive(TWO[0], {"teeth": 60, "at": [20, 0]})
    (problem,) = caught.value.problems
    place = [float(length) for length in re.findall(r"([-\d.]+) mm", problem.remedy)]
    assert problem.key == "pulleys[1].at" and drive(TWO[0], {"teeth": 60, "at": place}).design.moved < 1e-3


@pytest.mark.parametrize("profile", ["AT5", "S5M", "10B"])
def test_profile_without_published_sizes_is_refused_by_name(profile):
    with pytest.raises(RecipeError) as caught:
        drive(*TWO, belt={"profile": profile})
    assert caught.value.problems[0].key == "belt.profile"


@pytest.mark.parametrize("name", GALLERY)
def test_bill_and_steps_have_the_loop_and_every_shaft(name):
    own = recipe(name)
    (item,) = (line for line in own.bought if own.facts[0] == line.name)
    assert item.count == 1 and str(own.design.count) in item.name
    letters = {joint for line in own.bought for joint in line.joints}
    assert {"A", "B", "C"} <= letters
    assert all(any(f"{wheel.name} on " in step for step in own.steps) for wheel in own.design.wheels)


@pytest.mark.parametrize(("side", "room"), [("inside", "front"), ("outside", "back")])
@pytest.mark.parametrize("kind", GALLERY)
def test_smooth_idler_touches_the_face_of_the_loop_on_its_side(kind, side, room):
    low = -70 if side == "inside" else -12 if kind == "belt-drive" else -38
    smooth = {"diameter": 20, "at": [120, low], "side": side}
    own = drive({"teeth": 20}, smooth, {"teeth": 24, "at": [240, 0]}, kind=kind)
    faces = {"front": -own.profile.front, "back": own.profile.back}
    z = gk.flatten(own.design.loop.path(faces[room]), 1e-4)
    assert np.abs(z - own.design.axes[1]).min() == pytest.approx(10, abs=1e-3)
    assert own.design.wheels[1].name == "idler_2" and "idler_2" not in own.rotating_bodies


@pytest.mark.parametrize("kind", GALLERY)
def test_last_wheel_is_moved_by_at_most_a_link_and_counts_are_whole(kind):
    own = from_table(tomllib.loads(template_of(kind)))
    assert own.design.loop.length == pytest.approx(own.design.count, abs=1e-8)
    assert own.design.moved < own.profile.pitch and own.design.count % own.count_step == 0


def test_kinds_nearest_to_what_is_not_offered_exist():
    kinds = gk.recipe.kind_names()
    for nearest in NOT_OFFERED.values():
        assert any(word.strip(",") in kinds for word in nearest.split())
    with pytest.raises(RecipeError) as caught:
        from_table({"kind": "worm-gear"})
    assert NOT_OFFERED["worm"] in caught.value.problems[0].remedy


@pytest.mark.parametrize("torque", [30.0, 300.0])
def test_the_motor_of_a_loaded_drive_has_the_power_of_its_driven_wheel(torque):
    motor = {"name": "own", "torque_n_mm": 1000, "speed_rpm": 200, "lasting_torque_n_mm": 400, "mass_g": 100}
    loads = {"torques_n_mm": [torque], "speed_rpm": 50, "motor": motor}
    own = drive({"teeth": 24}, {"teeth": 48, "at": [100, 0]}, loads=loads)
    check = next(check for check in own.checks if check.id == "motor_torque")
    # Half the torque at twice the speed; at a quarter of its speed the motor has 750 N mm, but lasts with 400.
    assert check.value == pytest.approx(400 / (torque / 2))
    assert own.notes["loads"]["power_W"] == pytest.approx(1e-3 * torque * 25 * np.pi / 30, rel=1e-5)


def test_a_loaded_drive_names_the_lightest_motor_or_the_nearest_one():
    small, large = (
        drive({"teeth": 24}, {"teeth": 48, "at": [100, 0]}, loads={"torques_n_mm": [torque]}).notes["loads"]["motor"]
        for torque in (10.0, 1e5)
    )
    # No servo, which cannot turn on.
    assert small["margin"] >= 1.5 and gk.making.motor(small["motor"]).range_deg is None
    assert large["margin"] < 1.5
