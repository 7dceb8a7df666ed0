"""Cycloidal drives: published radii, the envelope of the pins, polygons that roll, virtual work, and refusals."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.core.errors import RecipeError
from geomkin.recipe.load import from_table
from tests.gallery import marks, named, point, recipe, seen

# Pins, circle, pin, eccentricity of published drives, and the least radius of curvature.
PUBLISHED = [(11, 200, 16, 7, 25.221), (10, 20, 3, 0.75, 2.826), (12, 180, 14, 4, 27.992)]
SMALL = {"eccentric": 20, "output_circle": 54, "output_pin": 6}


def sized(pins, circle, pin, eccentricity, **given):
    sizes = {"eccentric": 0.3 * circle, "output_circle": 0.6 * circle, "output_pin": 0.04 * circle, "output_pins": 4}
    return gk.cycloidal.CycloidalDrive(
        pins=pins, circle=circle, pin=pin, eccentricity=eccentricity, **{"clearance": 0.0, **sizes, **given}
    )


def drive(**given):
    own = {"pins": 11, "circle": 100, "pin": 8, "eccentricity": 3, **SMALL}
    tables = {key: given.pop(key) for key in ("stock", "loads") if key in given}
    return from_table({"kind": "cycloidal-drive", "cycloidal": own | given, **tables})


def polygon(z, rotation=1.0, at=0.0):
    z = at + rotation * z
    return shapely.Polygon(np.column_stack([z.real, z.imag]))


@pytest.mark.parametrize(("pins", "circle", "pin", "eccentricity", "radius"), PUBLISHED)
def test_least_radius_is_the_published_one_and_that_of_the_curve(pins, circle, pin, eccentricity, radius):
    own = sized(pins, circle, pin, eccentricity)
    assert own.least_radius == pytest.approx(radius, abs=6e-4)
    t = np.linspace(0, 2 * np.pi / own.lobes, 20_001)
    z = circle / 2 * np.exp(1j * t) - eccentricity * np.exp(1j * pins * t)
    first = np.gradient(z, t)
    curvature = (first.conj() * np.gradient(first, t)).imag / np.abs(first) ** 3
    assert 1 / curvature[5:-5].max() == pytest.approx(radius, rel=1e-4)


@pytest.mark.parametrize(("pins", "circle", "pin", "eccentricity", "radius"), PUBLISHED)
def test_disc_is_the_envelope_of_the_pins(pins, circle, pin, eccentricity, radius):
    """Pins are carried round the disc, which is held: what they leave is the disc."""
    own = sized(pins, circle, pin, eccentricity)
    disc = polygon(gk.flatten(own.outline, 1e-4 * circle / 100))
    turn = np.linspace(0, 2 * np.pi, 61)
    axis, direction = own.disc_pose(turn, 0)
    places = (circle / 2 * np.exp(2j * np.pi * np.arange(pins) / pins) - axis[:, None]) / direction[:, None]
    gaps = shapely.distance(shapely.points(places.real, places.imag), disc) - pin / 2
    assert np.abs(gaps).max() < 3e-6 * circle
    assert disc.is_valid


@pytest.mark.parametrize(("pins", "outputs", "is_same"), [(11, 4, True), (11, 6, False), (10, 6, True), (13, 8, True), (13, 4, False)])  # fmt: skip
def test_discs_roll_between_the_pins_with_the_output_in_their_holes(pins, outputs, is_same):
    own = drive(pins=pins, discs=2, output_pins=outputs, clearance=0.1, eccentricity=2.5, output_circle=56)
    names = [part.name for part in own.parts]
    assert ("disc_2" in names) == (not is_same) and own.parts[0].count == (2 if is_same else 1)
    scene = own.scene
    circles = [mark for mark in marks(scene, "circle") if mark.label == "pin"]
    for frame in (0, 3, 17, 40, 101):
        for disc in ("disc", "disc 2"):
            plate = seen(named(scene, disc), frame)
            for mark in circles:
                gap = plate.distance(point(mark.place[frame])) - mark.radius[frame]
                assert gap > 0.09
            gaps = [plate.exterior.distance(point(m.place[frame])) - m.radius[frame] for m in circles[:pins]]
            assert np.abs(np.array(gaps) - 0.1).max() < 1e-3
            eccentric = seen(named(scene, disc.replace("disc", "input")), frame)
            assert plate.intersection(eccentric).area < 1e-9


def test_output_turns_back_once_in_as_many_turns_as_lobes():
    scene = recipe("cycloidal-drive").scene
    turns = [np.unwrap(np.angle(named(scene, name).direction))[-1] for name in ("input", "output", "disc")]
    assert turns[0] == pytest.approx(20 * np.pi) and turns[1] == pytest.approx(-2 * np.pi) == turns[2]


@pytest.mark.parametrize("pins", [10, 11, 20, 30])
def test_forces_of_pins_balance_the_torque_and_their_peak_is_the_known_one(pins):
    own = sized(pins, 100, 1, 1.2)
    turn = np.linspace(0, 2 * np.pi, 200)
    force, bearing = own.pin_forces(1000.0, turn)
    places = 50 * np.exp(2j * np.pi * np.arange(pins) / pins)
    axis, direction = own.disc_pose(turn, 0)
    # The gap of each pin closes by its arm for a small rotation of the disc about its own axis.
    disc, h = polygon(gk.flatten(own.outline, 1e-5)), 1e-4
    for k in (0, 60):
        local = (places - axis[k]) / direction[k]
        turned = local * np.exp(-1j * h)
        change = [disc.exterior.distance(point(a)) - disc.exterior.distance(point(b)) for a, b in zip(local, turned)]
        inside = np.array([disc.contains(point(z)) for z in turned])
        arms = np.abs(np.array(change)) / h * ~inside
        moment = float(np.sum(force[k] * arms))
        assert moment == pytest.approx(1000.0, rel=0.02)
    peak = 4 * 1000 / (own.shortening * own.lobes * 50)
    assert 0.99 < force.max() / peak < 1.07
    assert 1.0 < bearing.max() / (1000 / (own.eccentricity * own.lobes)) < 1.12
    assert 0.35 * pins < np.count_nonzero(force > 1e-9, axis=1).mean() < 0.6 * pins


def test_contact_curvature_is_that_of_the_outline():
    own = sized(11, 100, 8, 3)
    (turn,) = turns = np.array([0.7])
    z = gk.flatten(own.outline, 1e-6)
    axis, direction = own.disc_pose(turn, 0)
    centre = (50 * np.exp(2j * np.pi * np.arange(11) / 11) - axis) / direction
    for k, place in enumerate(centre):
        nearest = np.abs(z - place).argmin()
        a, b, c = z[nearest - 6], z[nearest], z[(nearest + 6) % len(z)]
        area = ((b - a).conjugate() * (c - a)).imag / 2
        circle = 4 * area / (abs(b - a) * abs(c - b) * abs(c - a))
        assert own.contact_curvature(turns)[0, k] - 2 / 8 == pytest.approx(circle, abs=2e-3)


REFUSED = {
    "cycloidal.pin": {"pin": 28},
    "cycloidal.eccentricity": {"eccentricity": 5},
    "cycloidal.output_circle": {"output_circle": 95},
    "cycloidal.output_pins": {"output_pins": 20},
    "cycloidal.pins": {"pins": 2},
    "cycloidal.eccentric": {"eccentric": 5, "output_circle": 40},
}


@pytest.mark.parametrize("key", REFUSED)
def test_refused_sizes_are_named(key):
    with pytest.raises(RecipeError) as caught:
        drive(**REFUSED[key])
    assert [problem.key for problem in caught.value.problems] == [key]


def test_the_thickest_pin_that_is_advised_works_and_a_thicker_one_is_undercut():
    own = sized(9, 100, 8, 4.4, eccentric=10, output_circle=45, output_pin=2)
    with pytest.raises(gk.DesignError) as caught:
        sized(9, 100, 30, 4.4)
    most = caught.value.value
    assert sized(9, 100, 0.999 * most, 4.4, eccentric=10, output_circle=40, output_pin=2).least_radius > 0.49 * most
    assert most == pytest.approx(2 * own.least_radius, rel=1e-3)


def test_a_machine_turns_a_crank_by_the_output():
    own = {"kind": "cycloidal-drive", "cycloidal": {"pins": 11, "circle": 100, "pin": 8, "eccentricity": 3, **SMALL},
           "loads": {"torque_n_mm": 500}}  # fmt: skip
    pair = {"kind": "gear-pair", "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
            "second": {"teeth": 36, "module": 2}}  # fmt: skip
    placed = {"recipe": own, "turned_by": "pair.second", "angle_deg": 40, "upside_down": True}
    machine = from_table({"kind": "machine", "mechanisms": {"pair": {"recipe": pair}, "slow": placed}})
    turns = {name: np.unwrap(np.angle(named(machine.scene, name).direction)) for name in ("slow/input", "slow/output")}
    fast, slow = ((angle - angle[0])[-1] for angle in turns.values())
    assert abs(fast) > 1 and slow == pytest.approx(-fast / 10)
    assert np.abs(machine.table["input_torque"]) == pytest.approx(500 / 10 / 3)


def test_pins_that_meet_and_an_undercut_profile_are_two_refusals():
    def refusal(**sizes):
        with pytest.raises(gk.DesignError) as caught:
            sized(**{"pins": 11, "circle": 100, "pin": 8, "eccentricity": 3, **sizes})
        return caught.value.problem.partition("with which")[2]

    assert refusal(eccentricity=4.5) != refusal(pin=29, eccentricity=1)
