"""Gear meshes: the motion against circles drawn by hand, forces by power and levers, gears against their cut outlines."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.linkage.parts.stack import link_parts, stack_links
from geomkin.linkage.parts.stock import LinkStock

TURN = np.linspace(0, 4 * np.pi, 41)
FIVE_BAR = {
    "ground": {"O": 0, "C": 80},
    "crank": {"O": 0, "A": 20},
    "other_crank": {"C": 0, "D": 25},
    "coupler": {"A": 0, "B": 60, "pen": 70 + 10j},
    "link": {"D": 0, "B": 65},
}
PLACE = {"origin": 3 + 2j, "ground_angle_deg": 20}


def five_bar(teeth, angle_deg=30.0, idler=0, **place):
    """The five-bar with two gears, or with an idler between them."""
    if not idler:
        return gk.Linkage(
            FIVE_BAR, "crank", meshes=(gk.GearMesh("gears", "crank", "other_crank", teeth, angle_deg),), **place
        )
    at = 80 * (teeth[0] + idler) / (teeth[0] + 2 * idler + teeth[1])
    bodies = {**FIVE_BAR, "ground": {**FIVE_BAR["ground"], "I": at}, "idler": {"I": 0}}
    meshes = (
        gk.GearMesh("first", "crank", "idler", (teeth[0], idler)),
        gk.GearMesh("last", "idler", "other_crank", (idler, teeth[1]), angle_deg),
    )
    return gk.Linkage(bodies, "crank", meshes=meshes, **place)


@pytest.mark.parametrize(
    ("teeth", "idler", "ratio"),
    [
        ((20, 20), 0, -1),
        ((40, 20), 0, -2),
        ((20, 40), 0, -0.5),
        ((20, 20), 12, 1),
        ((36, 18), 15, 2),
        ((45, 15), 20, 3),
    ],
)
def test_motion_is_that_of_circles_about_both_crank_pins(teeth, idler, ratio):
    motion = gk.move(five_bar(teeth, idler=idler, **PLACE), TURN, speed=2.0)
    first, second = 20 * np.exp(1j * TURN), 80 + 25 * np.exp(1j * (np.radians(30) + ratio * TURN))
    between = second - first
    far = np.abs(between)
    along = (far**2 + 60**2 - 65**2) / (2 * far)
    joint = first + between / far * (along + 1j * np.sqrt(60**2 - along**2))
    assert np.abs(motion.point("B").position - (3 + 2j + np.exp(1j * np.radians(20)) * joint)).max() < 1e-12
    assert motion.other_crank.omega == pytest.approx(2 * ratio)
    assert motion.residual.max() < 1e-12


def test_equal_gears_run_the_joint_of_equal_rods_along_a_line():
    bodies = {**FIVE_BAR, "other_crank": {"C": 0, "D": 20}, "link": {"D": 0, "B": 60}}
    motion = gk.move(replace(five_bar((24, 24), 180.0), bodies=bodies), TURN)
    assert np.abs(motion.point("B").position.real - 40).max() < 1e-12


@pytest.mark.parametrize("idler", [0, 14])
def test_forces_balance_on_each_body_and_in_power(idler):
    """The driver's power is that of the load; the torque on the second crank is the tooth force at its pitch radius."""
    motion, force = gk.move(five_bar((36, 18), idler=idler, **PLACE), TURN, speed=2.0), 3 - 5j
    analysis = gk.forces(motion, gk.Loads(forces=[gk.Force("coupler", "pen", force)]))
    power = (np.conj(force) * motion.point("pen").velocity).real
    assert analysis.driver * 2 == pytest.approx(-power, abs=1e-9)
    tooth = analysis.mesh("last" if idler else "gears")
    radius = 80 * 18 / (36 + 2 * idler + 18)
    arm = motion.point("D").position - motion.point("C").position
    torque = (np.conj(arm) * analysis.pin("D", "other_crank")).imag
    assert -radius * tooth + torque == pytest.approx(0, abs=1e-9)
    if idler:
        # Both teeth press on the idler alike, and its pin takes both.
        assert analysis.mesh("first") == pytest.approx(-tooth)
        assert np.abs(analysis.pin("I", "idler")) == pytest.approx(2 * np.abs(tooth))


def test_teeth_press_the_gears_apart_on_their_pivots():
    """The load acts on the second crank alone: on the second gear act its pivot, the load and the teeth, at 20 deg."""
    motion = gk.move(five_bar((36, 18), **PLACE), TURN)
    second, load = motion.point("C").position, 7 - 2j
    loads = gk.Loads(forces=[gk.Force("other_crank", "D", load)])
    analysis, apart = gk.forces(motion, loads), np.exp(1j * np.radians(20))
    torque = (np.conj(motion.point("D").position - second) * load).imag
    tooth = torque / (80 * 18 / 54)
    teeth = 1j * apart * tooth + np.abs(tooth) * np.tan(np.radians(20)) * apart
    assert analysis.mesh("gears") == pytest.approx(tooth)
    assert analysis.pin("C", "other_crank") == pytest.approx(-load - teeth)
    # The crank carries nothing but the opposite force.
    assert analysis.pin("O", "crank") == pytest.approx(teeth)
    for body, _, force, _ in motion.linkage.meshes[0].forces(analysis, analysis.wrenches):
        assert force == pytest.approx(teeth if body == "other_crank" else -teeth)


@pytest.mark.parametrize(("size", "step"), [("gears.angle_deg", np.degrees(1e-6)), ("ground.C.x", 1e-5)])
def test_derivatives_by_sizes_agree_with_central_differences(size, step):
    linkage = five_bar((40, 20), **PLACE)

    def changed(by):
        if size.startswith("ground"):
            ground = {"ground": {"O": 0, "C": 80 + by}}
            return replace(linkage, bodies={**FIVE_BAR, **ground})
        return replace(linkage, meshes=(replace(linkage.meshes[0], angle_deg=30 + by),))

    ends = [gk.move(changed(sign * step), TURN, speed=2.0).point("pen") for sign in (1, -1)]
    unit = np.radians(step) if size.endswith("deg") else step
    motion = gk.move(linkage, TURN, speed=2.0)
    for of, rate in (("pen", "position"), ("pen_velocity", "velocity")):
        difference = (getattr(ends[0], rate) - getattr(ends[1], rate)) / (2 * unit)
        assert np.abs(motion.sensitivity(of, size) - difference).max() < 1e-5


def cut(motion, stock, frame):
    """Outlines of the gears at a frame, as polygons, by the names of their parts."""
    stack = stack_links(motion, stock)
    polygons = {}
    for part in link_parts(motion, stock, stack):
        if stack.plates.get(part.name) is not None and stack.plates[part.name].wheel is not None:
            body = motion.bodies[part.body]
            places = body.origin.position[frame] + body.direction[frame] * gk.flatten(part.outline, 0.002)
            polygons[part.name] = shapely.Polygon(np.column_stack([places.real, places.imag]))
    return polygons, stack


@pytest.mark.parametrize(("teeth", "idler"), [((24, 24), 0), ((36, 18), 0), ((30, 15), 12)])
def test_cut_gears_mesh_and_lie_in_one_layer(teeth, idler):
    """They do not overlap at any frame, but do if one is turned by more than the backlash either way."""
    motion = gk.move(five_bar(teeth, idler=idler, **PLACE), np.linspace(0, 2 * np.pi, 73))
    for frame in (0, 7, 50):
        gears, stack = cut(motion, LinkStock(bar_width=8, pin_diameter=2), frame)
        assert len(gears) == 2 + bool(idler)
        assert len({stack.layers[name] for name in gears}) == 1
        names = ["crank", *(["idler"] if idler else []), "other_crank"]
        ordered = [next(gear for name, gear in gears.items() if name.startswith(body)) for body in names]
        for one, two in zip(ordered, ordered[1:]):
            assert one.intersection(two).area < 1e-3
            centre = two.centroid
            for turn in (1.5, -1.5):
                assert one.intersection(shapely.affinity.rotate(two, turn, centre)).area > 1e-2


def test_a_gear_is_the_crank_if_its_pin_has_room_in_it_and_else_fixed_by_two_pins():
    """Ratio 2 makes the second gear too small for its crank."""
    motion, stock = gk.move(five_bar((36, 18)), np.linspace(0, 2 * np.pi, 73)), LinkStock(bar_width=8, pin_diameter=3)
    stack = stack_links(motion, stock)
    pins = {pin.name: pin.holes for pin in stack.pins}
    assert stack.plates["crank"].wheel is not None and stack.plates["other_crank"].wheel is None
    assert {"other_crank", "other_crank_gear"} <= {*pins["C"]} and pins["other_crank_gear_pin"] == (
        "other_crank",
        "other_crank_gear",
    )
    parts = {part.name: part for part in link_parts(motion, stock, stack)}
    both = [{hole.centre for hole in parts[name].holes} for name in ("other_crank", "other_crank_gear")]
    assert both[1] < both[0] and len(both[1]) == 2


@pytest.mark.parametrize("at", [[-44, 0], [-44, 10], [-20, -38]])
def test_the_pin_that_fixes_a_gear_is_where_the_holes_leave_room(at):
    """On a circle about the pivot, no farther from the nearest other hole than it could be, within a sixteenth turn."""
    arm = {"name": "arm", "body": "crank", "at": at, "screw": "M3"}
    text = recipe(stock={"bar_width": 12, "pin_diameter": 4, "attachments": [arm]})
    text["linkage"]["meshes"][0]["teeth"] = [24, 24]
    parts = {part.name: part for part in gk.load(text).parts}
    (pin,) = {hole.centre for hole in parts["crank_gear"].holes} - {0j}
    others = np.array([hole.centre for hole in parts["crank"].holes if hole.centre not in (0, pin)])
    assert len(others) == 2 and {pin, 0j} < {hole.centre for hole in parts["crank"].holes}
    clear = np.abs(abs(pin) * np.exp(1j * np.linspace(0, 2 * np.pi, 721))[:, None] - others).min(axis=1).max()
    assert np.abs(pin - others).min() > clear - abs(pin) * np.pi / 16 - 0.5


def test_a_gear_too_small_for_its_own_pin_is_refused():
    with pytest.raises(gk.DesignError) as refusal:
        stack_links(gk.move(five_bar((34, 34), idler=9), [0.0, 0.1]), LinkStock(bar_width=16, pin_diameter=10))
    assert refusal.value.field == "meshes"


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"second": "coupler"}, "meshes"),
        ({"second": "crank"}, "meshes"),
        ({"second": "ground"}, "meshes"),
        ({"teeth": (5, 20)}, "teeth"),
        ({"teeth": (20.5, 20)}, "teeth"),
        ({"name": ""}, "meshes"),
    ],
)
def test_invalid_mesh_is_refused(change, field):
    with pytest.raises(gk.DesignError) as refusal:
        mesh = gk.GearMesh(**{"name": "gears", "first": "crank", "second": "other_crank", "teeth": (20, 20), **change})
        gk.Linkage(FIVE_BAR, "crank", meshes=(mesh,))
    assert refusal.value.field == field


def test_driver_must_be_geared_and_a_gear_has_one_size():
    with pytest.raises(gk.DesignError, match="crank"):
        gk.move(replace(five_bar((20, 20)), driver="coupler"), [0.0])
    far = five_bar((20, 20), idler=12)
    wrong = replace(far, bodies={**far.bodies, "ground": {**far.bodies["ground"], "I": 41}})
    for linkage in (wrong, replace(far, meshes=(far.meshes[0], replace(far.meshes[1], teeth=(14, 18))))):
        with pytest.raises(gk.DesignError) as refusal:
            stack_links(gk.move(linkage, np.linspace(0, 6, 40)), LinkStock(bar_width=8, pin_diameter=3))
        assert refusal.value.field == "meshes"


def recipe(unit=1.0, **more):
    """A recipe of the five-bar, lengths in a unit of so many mm."""
    bodies = {
        body: {point: [np.real(z) / unit, np.imag(z) / unit] for point, z in points.items()}
        for body, points in FIVE_BAR.items()
    }
    mesh = {"name": "gears", "first": "crank", "second": "other_crank", "teeth": [40, 20], "angle_deg": 30}
    return {"kind": "linkage", "linkage": {"driver": "crank", "bodies": bodies, "meshes": [mesh]}, **more}


def test_recipe_is_the_same_in_inches_and_at_an_angle_upside_down_in_a_machine():
    alone = gk.load(recipe())
    pen = alone.motion.point("pen").position
    assert np.abs(gk.load(recipe(25.4, units="in")).motion.point("pen").position - pen).max() < 1e-9
    placed = {"recipe": recipe(), "upside_down": True, "angle_deg": 30, "turned_by": "a.crank", "phase_deg": 10}
    machine = gk.load({"kind": "machine", "mechanisms": {"a": {"recipe": recipe()}, "b": placed}})
    (mark,) = (mark for mark in machine.scene.marks if mark.label == "b pen")
    own = gk.move(alone.linkage, np.radians(machine.table["b_driver_angle"])).point("pen").position
    assert np.abs(mark.place - np.exp(1j * np.pi / 6) * own).max() < 1e-9
    layers = {body.name: body.layer for body in machine.scene.bodies}
    assert layers["b/crank"] == layers["b/other_crank_gear"] > layers["a/crank"] == layers["a/other_crank_gear"]


@pytest.mark.parametrize(("body", "bar_width", "has_end"), [("other_crank", 8, True), ("crank", 8, False)])
def test_a_body_that_is_a_gear_is_refused_a_counterweight(body, bar_width, has_end):
    """The smaller gear is fixed on a bar, which gets one."""
    weights = {"bodies": [body], "distance": 20, "largest_radius": 15}
    stock = {"material": "birch-plywood", "bar_width": bar_width, "pin_diameter": 3}
    text = recipe(stock=stock, loads={"counterweights": weights})
    if has_end:
        (plain,), (part,) = (
            [part for part in gk.load(text).parts if part.name == body] for text in (recipe(stock=stock), text)
        )
        assert gk.area(part.outline) > gk.area(plain.outline) + 10
        return
    with pytest.raises(gk.DesignError) as refusal:
        gk.load(text).parts
    assert refusal.value.field == "loads.counterweights.bodies" and body in refusal.value.problem
