"""Geneva drives: published peaks, central differences, polygons that turn past each other, energy, and refusals."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.core.errors import DesignError, RecipeError
from geomkin.geneva.wheel import dwell_share, most_pins
from geomkin.recipe.load import from_table
from tests.gallery import marks, named, point, recipe, seen

# Largest speed, acceleration at entry, largest acceleration, its angle in deg, and jerk amidst, by the number of slots.
PEAKS = {
    3: (6.4641, 1.7321, 31.392, 4.758, 672.02), 4: (2.4142, 1.0, 5.4070, 11.464, 48.042),
    5: (1.4259, 0.7265, 2.2988, 17.571, 13.324), 6: (1.0, 0.5774, 1.3496, 22.903, 6.0),
    8: (0.6199, 0.4142, 0.6998, 31.642, 2.2493), 12: (0.3492, 0.2679, 0.3477, 44.005, 0.800),
}  # fmt: skip
# Slots, pins and distance, and whether the wheel is internal.
DRIVES = [(3, 1, 100, 0), (3, 4, 100, 0), (4, 1, 60, 0), (4, 3, 60, 0), (5, 3, 80, 0), (7, 2, 80, 0), (12, 2, 120, 0),
          (24, 2, 250, 0), (3, 1, 60, 1), (4, 1, 45, 1), (7, 1, 80, 1), (12, 1, 120, 1), (24, 1, 250, 1)]  # fmt: skip


def drive(**given):
    tables = {key: given.pop(key) for key in ("stock", "loads", "drive") if key in given}
    return from_table({"kind": "geneva", "geneva": {"distance": 60, **given}, **tables})


def polygon(z, hole=None):
    return shapely.Polygon(*([np.column_stack([z.real, z.imag])] if hole is None else [
        np.column_stack([z.real, z.imag]), [np.column_stack([hole.real, hole.imag])]]))  # fmt: skip


def outlines(wheel, tolerance):
    """Of the wheel, with its opening if it is internal, as chords."""
    return [gk.flatten(curve, tolerance) for curve in (wheel.outline, *([wheel.opening] if wheel.internal else []))]


@pytest.mark.parametrize("slots", PEAKS)
def test_peaks_are_the_published_ones(slots):
    wheel = gk.geneva.GenevaWheel(100, slots=slots)
    velocity, most, entry, jerk = wheel.peaks
    speed, at_entry, largest, at, amidst = PEAKS[slots]
    assert (velocity, entry, most, jerk) == pytest.approx((speed, at_entry, largest, amidst), rel=2e-4, abs=6e-4)
    turn = np.linspace(0, 2 * np.pi, 200_001)
    first, second = wheel.derivatives(turn)
    assert np.abs(first).max() == pytest.approx(velocity) and np.abs(second).max() == pytest.approx(most, rel=1e-6)
    h = 1e-4
    assert abs(np.diff(wheel.derivatives(np.pi + np.array([-h, h]))[1])[0]) / (2 * h) == pytest.approx(jerk, rel=1e-4)
    assert abs(np.degrees(turn[np.abs(second).argmax()]) - 180) == pytest.approx(at, abs=3e-3)


@pytest.mark.parametrize("slots", [3, 4, 7, 24])
def test_peaks_of_an_internal_wheel_are_those_of_its_rotation(slots):
    """Differences of the direction of the pin from the wheel's axis."""
    wheel = gk.geneva.GenevaWheel(100, slots=slots, internal=True, roller=1, tip_width=0.5)
    half = np.pi / 2 + np.pi / slots

    def turned(p):
        return np.angle(100 + wheel.crank_radius * np.exp(1j * np.asarray(p)))

    assert turned(half) - turned(-half) == pytest.approx(2 * np.pi / slots)
    p, h = np.linspace(-half, half, 20_001), 1e-4
    velocity = (turned(p + h) - turned(p - h)) / (2 * h)
    acceleration = (turned(p + h) - 2 * turned(p) + turned(p - h)) / h**2
    jerk = abs(turned(4e-3) - 2 * turned(2e-3) + 2 * turned(-2e-3) - turned(-4e-3)) / (2 * 2e-3**3)
    wanted = velocity.max(), np.abs(acceleration).max(), abs(acceleration[-1]), jerk
    assert wheel.peaks == pytest.approx(wanted, rel=1e-4)
    assert velocity[0] == pytest.approx(0, abs=1e-6) and np.abs(acceleration).argmax() in (0, 20_000)


@pytest.mark.parametrize(("slots", "pins", "distance", "internal"), DRIVES)
def test_derivatives_are_central_differences_and_each_step_is_a_pitch(slots, pins, distance, internal):
    wheel = gk.geneva.GenevaWheel(distance, slots=slots, pins=pins, internal=bool(internal))
    turn = np.random.default_rng(1).uniform(-7, 7, 400)
    h, (angle, _) = 1e-5, wheel.pin_angle(turn)
    turn = turn[np.abs(np.abs(angle) - wheel.half_motion) > 1e-3]
    first, second = wheel.derivatives(turn)
    assert (wheel.rotation(turn + h) - wheel.rotation(turn - h)) / (2 * h) == pytest.approx(first, abs=1e-6)
    change = (wheel.derivatives(turn + h)[0] - wheel.derivatives(turn - h)[0]) / (2 * h)
    assert change == pytest.approx(second, abs=1e-4)
    steps = wheel.rotation(2 * np.pi / pins * np.arange(5))
    assert steps == pytest.approx((1 if internal else -1) * 2 * np.pi / slots * np.arange(5))
    still = np.linspace(0, 2 * np.pi, 20_000, endpoint=False)
    assert np.mean(wheel.derivatives(still)[0] == 0) == pytest.approx(wheel.dwell, abs=2e-4)


def clears(wheel, step_deg):
    """The wheel, its lock and its rollers turn without meeting; rollers have half the clearance on either side."""
    (_, pins), distance = wheel.numbers, wheel.distance
    plate, lock = outlines(wheel, 1e-3), gk.flatten(wheel.lock_outline, 1e-3)
    assert polygon(*plate).is_valid and polygon(lock).is_valid
    for turn in np.radians(np.arange(0, 360 / pins, step_deg)):
        turned = polygon(*(distance - z * np.exp(1j * wheel.rotation(turn)) for z in plate))
        # The pin of an internal wheel is beyond the crank's axis as it moves the wheel.
        direction = np.exp(1j * (turn - (0 if wheel.internal else np.pi / pins)))
        assert turned.intersection(polygon(lock * direction)).area == 0
        for place in wheel.pin_places:
            z = place * direction
            gap = turned.distance(point(z)) - wheel.roller / 2
            assert gap > -1e-3
            if abs(np.angle(-z if wheel.internal else z)) < wheel.half_motion - 0.05:
                assert gap == pytest.approx(wheel.clearance / 2, abs=2e-3)


@pytest.mark.parametrize(("slots", "pins", "distance", "internal"), DRIVES)
def test_wheel_clears_disc_and_rollers_and_a_roller_is_in_a_slot(slots, pins, distance, internal):
    wheel = gk.geneva.GenevaWheel(distance, slots=slots, pins=pins, internal=bool(internal))
    clears(wheel, 5.0 if slots > 9 or internal else 1.0)


@pytest.mark.parametrize("slots", [3, 6, 24])
@pytest.mark.parametrize("key", ["tip_width", "roller"])
def test_an_internal_wheel_of_the_largest_tips_or_rollers_clears_its_lock(slots, key):
    given = {"tip_width": 0.02, "roller": 1.0, key: 500.0}
    with pytest.raises(DesignError) as caught:
        gk.geneva.GenevaWheel(100, slots=slots, internal=True, clearance=0.1, **given)
    assert caught.value.field == key
    given[key] = 0.97 * caught.value.value
    clears(gk.geneva.GenevaWheel(100, slots=slots, internal=True, clearance=0.1, **given), 3.0)


@pytest.mark.parametrize(("slots", "internal"), [(3, 0), (4, 0), (6, 0), (12, 0), (3, 1), (4, 1), (12, 1)])
def test_play_of_the_locked_wheel_is_that_of_polygons(slots, internal):
    wheel = gk.geneva.GenevaWheel(120, slots=slots, clearance=0.4, internal=bool(internal))
    plate, lock = outlines(wheel, 1e-5), gk.flatten(wheel.lock_outline, 1e-5)
    disc = polygon(lock if internal else -lock)
    for share, meets in ((0.9, False), (1.1, True)):
        for side in (1, -1):
            turned = polygon(*(120 - z * np.exp(1j * side * share * wheel.lock_play) for z in plate))
            assert (turned.intersection(disc).area > 0) == meets


@pytest.mark.parametrize(("slots", "internal"), [(3, 0), (4, 0), (12, 0), (3, 1), (4, 1)])
def test_tips_too_thin_to_cut_fail_a_check_of_their_width(slots, internal):
    """The width is the distance of the corner of a slot's mouth from the locking arc."""
    for width, thickness in ((0.01, 1), (1.0, 1), (1.0, 4)):
        own = drive(distance=120, slots=slots, internal=bool(internal), tip_width=width, stock={"thickness": thickness})
        (check,) = (check for check in own.checks if check.id == "tip_width")
        assert check.passed == (width >= thickness / 3)
        wheel = own.geneva
        side = np.exp(-1j * np.pi / slots)
        corner = (wheel.distance * np.cos(np.pi / slots) + 1j * wheel.half_width) * side
        arc = shapely.Point(wheel.distance, 0).buffer(wheel.lock_radius + wheel.clearance / 2, quad_segs=20000)
        assert arc.distance(shapely.Point(corner.real, corner.imag)) == pytest.approx(check.value, abs=1e-5)


@pytest.mark.parametrize("share", [0.75, 2 / 3, 0.5, 0.25])
def test_a_wanted_dwell_gives_slots_and_pins(share):
    wheel = gk.geneva.GenevaWheel(100, dwell_share=share)
    slots, pins = wheel.numbers
    assert 1 - pins * (slots - 2) / (2 * slots) == pytest.approx(share) == wheel.dwell


def test_a_dwell_that_no_wheel_has_names_the_two_nearest():
    with pytest.raises(RecipeError) as caught:
        drive(dwell_share=0.45)
    (problem,) = caught.value.problems
    near = [float(word) for word in problem.remedy.replace("give ", "").split() if word.startswith("0.")]
    every = [dwell_share(n, k) for k in range(1, 6) for n in range(3, 25) if k <= most_pins(n)]
    assert problem.key == "geneva.dwell_share"
    assert near == pytest.approx([max(s for s in every if s < 0.45), min(s for s in every if s > 0.45)])


def test_most_pins_are_the_known_ones():
    assert [most_pins(n) for n in (3, 4, 5, 6, 8)] == [5, 3, 3, 2, 2]
    assert {most_pins(n, internal=True) for n in range(3, 25)} == {1}


def test_a_wanted_dwell_of_an_internal_wheel_names_those_that_have_it():
    assert gk.geneva.GenevaWheel(60, dwell_share=1 / 3, internal=True).numbers == (6, 1)
    with pytest.raises(DesignError) as caught:
        gk.geneva.GenevaWheel(60, dwell_share=0.75, internal=True)
    assert caught.value.field == "dwell_share" and f"{(24 - 2) / (2 * 24):.7g}" in caught.value.remedy


REFUSED = {
    "geneva.slots": {"slots": 2},
    "geneva.pins": {"slots": 6, "pins": 3},
    "geneva.pins ": {"slots": 6, "pins": 2, "internal": True},
    "geneva.roller": {"slots": 4, "roller": 30},
    "geneva.tip_width": {"slots": 4, "tip_width": 30},
    "stock.pin": {"slots": 4, "stock": {"pin": 6}},
    "loads.torque_n_mm": {"slots": 4, "loads": {}},
}


@pytest.mark.parametrize("key", REFUSED)
def test_refused_values_are_named(key):
    with pytest.raises(RecipeError) as caught:
        drive(**REFUSED[key])
    assert [problem.key for problem in caught.value.problems] == [key.strip()]


def test_a_shaft_wider_than_the_locking_disc_has_room_for_is_refused():
    with pytest.raises(DesignError) as caught:
        drive(slots=8, stock={"bore": 10}).parts
    assert caught.value.field == "stock.bore"
    with pytest.raises(DesignError) as caught:
        drive(slots=3, stock={"wheel_bore": 20}).parts
    assert caught.value.field == "stock.wheel_bore"


@pytest.mark.parametrize("key", ["roller", "tip_width"])
def test_the_advised_limit_works(key):
    with pytest.raises(RecipeError) as caught:
        drive(slots=4, **{key: 30})
    most = float(caught.value.problems[0].value)
    drive(slots=4, **{key: 0.99 * most, **({"tip_width": 0.01} if key == "roller" else {})})


@pytest.mark.parametrize("name", ["geneva", "internal-geneva"])
def test_torque_does_the_work_of_the_load_and_the_inertia_takes_none(name):
    own = recipe(name)
    aspect, wheel = own.aspect("loads"), own.geneva
    turn = np.pi + np.linspace(-1, 1, 20_001) * wheel.half_motion * (1 - 1e-12)
    force, torque = aspect.forces(turn)
    work = np.trapezoid(torque, turn)
    assert work == pytest.approx(own.loads.torque_n_mm * 2 * np.pi / 4, rel=1e-6)
    # The force turns the wheel about its axis by the distance of the pin, along the slot's normal.
    arm = np.abs(wheel.distance - own.plates.crank_direction(turn) * wheel.crank_radius)
    first, _ = wheel.derivatives(turn)
    inertia = own.loads.inertia_kg_mm2 + own.body_masses["wheel"].inertia
    kinetic = inertia * (first * own.drive.speed) ** 2 / 2 * 1e-3
    change = np.gradient(kinetic, turn) + own.loads.torque_n_mm * np.abs(first)
    assert force[5:-5] * arm[5:-5] * np.abs(first[5:-5]) == pytest.approx(change[5:-5], abs=0.02)


@pytest.mark.parametrize("name", ["geneva", "internal-geneva"])
def test_scene_moves_the_parts_that_are_cut(name):
    scene = recipe(name).scene
    (roller,) = marks(scene, "circle")
    for frame in range(0, len(scene.time), 9):
        wheel, lock = (seen(named(scene, name), frame) for name in ("wheel", "lock"))
        assert wheel.intersection(lock).area < 1e-9
        assert wheel.distance(point(roller.place[frame])) >= roller.radius[frame] - 1e-3
    first, last = (seen(named(scene, "wheel"), frame) for frame in (0, -1))
    assert first.symmetric_difference(last).area < 1e-6


def test_crank_room_is_that_of_polygons():
    own = recipe("geneva")
    _, _, crank, _ = own.parts
    arm = polygon(gk.flatten(crank.outline, 1e-4))
    rooms = [shapely.affinity.rotate(arm, angle, (0, 0)).distance(shapely.Point(60, 0)) - 5 for angle in range(-20, 21)]
    (room,) = (check.value for check in own.checks if check.id == "arm_room")
    assert room == pytest.approx(min(rooms), abs=1e-3)


def test_internal_plates_of_one_layer_clear_the_shafts_and_each_other():
    own = recipe("internal-geneva")
    scene, wheel = own.scene, own.geneva
    tube = point(wheel.distance).buffer(5)
    for frame in range(0, len(scene.time), 9):
        ring, disc, lock, crank = (seen(named(scene, name), frame) for name in ("wheel", "disc", "lock", "crank"))
        assert not crank.intersects(tube) and not lock.intersects(tube) and not ring.intersects(tube)
        assert disc.contains(point(wheel.distance).buffer(6).boundary)
        assert lock.intersection(crank).area > 0.4 * lock.area
    # Nothing of the crank's shaft is in the wheel's layer: tips pass over its axis.
    assert any(seen(named(scene, "wheel"), frame).contains(point(0)) for frame in range(len(scene.time)))
    pins = own.parts[2].holes
    assert all(min(abs(z - place) for place in own.plates.lock_pins) < 1 for z in (pin.centre for pin in pins))


@pytest.mark.parametrize("internal", [False, True])
def test_a_shaft_of_a_machine_turns_it_turned_over_and_at_an_angle(internal):
    pair = {"kind": "gear-pair", "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
            "second": {"teeth": 36, "module": 2}}  # fmt: skip
    wheel = {"distance": 60, "slots": 4, "internal": internal}
    own = {"kind": "geneva", "geneva": wheel, "loads": {"torque_n_mm": 100}}
    placed = {"recipe": own, "turned_by": "pair.second", "angle_deg": 50, "upside_down": True}
    machine = from_table({"kind": "machine", "mechanisms": {"pair": {"recipe": pair}, "index": placed}})
    crank, wheel = (named(machine.scene, f"index/{name}") for name in ("crank", "wheel"))
    turned = np.unwrap(np.angle(wheel.direction / wheel.direction[0]))
    driver = np.unwrap(np.angle(crank.direction / crank.direction[0]))
    whole = round(abs(driver[-1]) / (2 * np.pi))
    way = np.sign(driver[-1]) * (1 if internal else -1)
    assert whole and turned[-1] == pytest.approx(way * whole * np.pi / 2, abs=1e-9)
    work = np.trapezoid(machine.table["input_torque"], machine.table["driver_angle"] * np.pi / 180)
    assert abs(work) == pytest.approx(100 * whole * np.pi / 2, rel=0.05)


def test_a_crank_that_turns_clockwise_moves_the_wheel_counterclockwise():
    own = drive(slots=4, drive={"speed_rpm": -30})
    angle = own.table["wheel_angle"]
    assert angle[-1] - angle[0] == pytest.approx(90) and np.diff(angle).min() >= -1e-9
    assert own.table["wheel_velocity"].min() >= 0


@pytest.mark.parametrize("internal", [False, True])
def test_a_wheel_without_bore_has_no_hole_on_its_axis(internal):
    made = drive(slots=6, distance=80, internal=internal, stock={"wheel_bore": 0})
    wheel = next(part for part in made.parts if part.name == ("disc" if internal else "wheel"))
    assert all(abs(hole.centre) > 1 for hole in wheel.holes if isinstance(hole, gk.plane.Circle))
    assert internal or not wheel.holes
