"""Forces of cams against virtual power, the equilibrium of the follower in its guide, energy, and published formulas."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam import FollowerLoads, GuideFriction, cam_forces, jump_speed, least_preload, least_stiffness
from tests.cam.cams import CAMS, LIFTS, SWINGS, programme
from tests.campaign import by_default

MASS = gk.Mass(0.4, centre=35 + 12j, inertia=300)
SLIDING = FollowerLoads(MASS, stiffness=3, preload=40, force=15, gravity=-9810j)
SWINGING = FollowerLoads(MASS, stiffness=9000, preload=2500, force=900, gravity=3000 - 9000j)
# Inside rise and return, away from joints.
MOVING = np.radians([65.0, 80.0, 117.0, 150.0, 175.0, 220.0, 260.0, 300.0, 350.0])
# An eccentric disk of 30 mm, 12 mm off its axis, under a flat face: its lift is harmonic.
ECCENTRIC = gk.Cam(
    gk.TranslatingFlat(),
    gk.Program((gk.Rise("harmonic", rise=24, end_deg=180), gk.Return("harmonic", end_deg=360))),
    base_radius=18,
)
JUMPING = gk.Cam(gk.TranslatingRoller(10), programme(15, laws=("uniform", "uniform")), 45)


def loads_of(cam):
    return SWINGING if cam.follower.oscillates else SLIDING


@pytest.mark.parametrize("name", list(CAMS))
def test_power_of_the_shaft_is_that_of_masses_spring_and_force(name):
    """Velocities and accelerations are central differences of the follower's pose over time; no contact force."""
    cam = CAMS[name]
    loads, speed, acceleration, step = loads_of(cam), 30.0, 200.0, 2e-5
    time = step * np.arange(-2, 3)[:, None]
    angle = MOVING + speed * time + acceleration * time**2 / 2
    pose = cam.follower_pose(angle)
    place = pose.origin + pose.direction * MASS.centre if cam.follower.oscillates else pose.origin
    turned = np.unwrap(np.angle(pose.direction), axis=0)
    first, second = np.array([1, -8, 0, 8, -1]) / (12 * step), np.array([-1, 16, -30, 16, -1]) / (12 * step**2)
    v, a, omega, alpha = first @ place, second @ place, first @ turned, second @ turned
    # Of the lift, rad of an arm or mm.
    rest = cam.follower.pose(np.zeros(()), cam.base_radius)
    lift = np.abs(turned - np.angle(rest.direction)) if cam.follower.oscillates else (place - rest.origin).imag
    pressing = loads.preload + loads.stiffness * lift[2] + loads.force
    power = 1e-3 * (MASS.mass * np.real(np.conj(a - loads.gravity) * v) + MASS.inertia * alpha * omega)
    power = power + pressing * (first @ lift)
    result = cam_forces(cam, loads, MOVING, speed=speed, acceleration=acceleration)
    # 1e-3 W per N mm/s.
    assert result.power == pytest.approx(1e-3 * power, rel=1e-6, abs=1e-6 * np.abs(1e-3 * power).max())


def equilibrium(cam, loads, angle, speed):
    """Contact force and sum of the pressures on the ends of the guide, from its three equations for each set of signs."""
    friction, step = loads.friction, 1e-4
    lift = cam.follower_pose(angle + step * np.arange(-1, 2)[:, None]).origin.imag
    at, rest = cam.contact(angle), cam.follower.pose(np.zeros(()), cam.base_radius).origin
    solved = []
    for k, (point, normal) in enumerate(zip(at.point, at.normal)):
        along = (lift[2, k] - 2 * lift[1, k] + lift[0, k]) / step**2 * speed**2 * loads.mass.mass * 1e-3
        along += loads.preload + loads.stiffness * (lift[1, k] - rest.imag) + loads.force + loads.mass.mass * 9.81
        ends = rest + 1j * (friction.overhang + np.array([0, friction.length]))
        up = np.sign(lift[2, k] - lift[0, k])
        found = []
        for signs in product((1, -1), repeat=2):
            # Unknown: contact force, and pressure of each end on the follower along x. Friction acts on the axis.
            rub = -up * friction.coefficient * np.array(signs)
            moment = (np.conj(point - rest.real) * normal).imag
            rows = [[normal.real, 1, 1], [normal.imag, *rub], [moment, -ends[0].imag, -ends[1].imag]]
            contact, *pressures = np.linalg.solve(rows, [0, along, 0])
            if np.all(np.array(signs) * pressures >= -1e-9):
                found.append((contact, np.abs(pressures).sum()))
        assert found and np.ptp(np.array(found), axis=0).max() < 1e-9 * abs(found[0][0])
        solved.append(found[0])
    return np.array(solved).T


GUIDED = [name for name, cam in CAMS.items() if not cam.follower.oscillates]


@pytest.mark.parametrize("name", GUIDED)
@pytest.mark.parametrize("speed", [40.0, 120.0])
def test_contact_force_balances_the_follower_in_its_guide(name, speed):
    """Also at a speed at which the force pulls at some angles."""
    cam = CAMS[name]
    loads = replace(SLIDING, friction=GuideFriction(0.12, length=55, overhang=28))
    contact = cam_forces(cam, loads, MOVING, speed=speed).contact
    assert (contact.min() < 0) == (speed == 120)
    assert contact == pytest.approx(equilibrium(cam, loads, MOVING, speed)[0], rel=1e-4)


@pytest.mark.parametrize("name", by_default(GUIDED, slice(0, None, 3)))
def test_work_of_the_shaft_over_a_turn_is_that_of_friction(name):
    cam, speed, count = CAMS[name], 40.0, 1440
    loads = replace(SLIDING, friction=GuideFriction(0.12, length=55, overhang=28))
    angle = 2 * np.pi * (np.arange(count) + 0.5) / count
    moving = angle[np.abs(cam.program.motion(angle).velocity) > 0]
    pressed = equilibrium(cam, loads, moving, speed)[1]
    half = np.pi / count
    travel = np.abs(cam.follower_pose(moving + half).origin - cam.follower_pose(moving - half).origin)
    mean = cam_forces(cam, loads, angle, speed=speed).torque.mean()
    assert 2 * np.pi * mean == pytest.approx(0.12 * np.sum(pressed * travel), rel=1e-4)


@pytest.mark.parametrize("name", list(CAMS))
def test_without_friction_the_mean_torque_is_zero(name):
    cam, count = CAMS[name], 7200
    torque = cam_forces(cam, loads_of(cam), 2 * np.pi * (np.arange(count) + 0.5) / count, speed=40.0).torque
    assert abs(torque.mean()) < 1e-6 * np.abs(torque).max()


def test_a_steep_cam_jams_a_short_guide():
    cam = gk.Cam(gk.TranslatingRoller(5), programme(25, ends=(60, 100, 210, 300)), 25)
    result = [
        cam_forces(cam, replace(SLIDING, friction=GuideFriction(0.3, length, 60)), np.radians([80.0, 255.0]), speed=1)
        for length in (15, 400)
    ]
    assert np.isnan([each.contact for each in result]).tolist() == [[True, False], [False, False]]


def kept(cam, loads, speed):
    """Whether the follower stays on the cam, by samples."""
    angle = np.linspace(0, 2 * np.pi, 8_001)[:-1]
    return cam_forces(cam, loads, angle, speed=speed).contact.min() >= 0


def limit(holds, low, high):
    """Where `holds` changes between low and high, by bisection."""
    at_low = holds(low)
    assert at_low != holds(high)
    for _ in range(32):
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) == at_low else (low, middle)
    return (low + high) / 2


SOUGHT = ["tilted, counterclockwise", "roller on arm, clockwise"]


@pytest.mark.parametrize("name", by_default(SOUGHT, SOUGHT[:1]))
def test_jump_speed_preload_and_stiffness_are_those_of_a_search(name):
    cam = CAMS[name]
    loads = loads_of(cam)
    speed = jump_speed(cam, loads)
    assert speed == pytest.approx(limit(lambda w: kept(cam, loads, w), 1, 1000), rel=1e-5)
    faster = 1.2 * speed
    preload = limit(lambda value: kept(cam, replace(loads, preload=value), faster), 0, 100 * loads.preload)
    assert least_preload(cam, loads, faster) == pytest.approx(preload, rel=1e-5)
    stiffness = limit(lambda value: kept(cam, replace(loads, stiffness=value), faster), 0, 100 * loads.stiffness)
    assert least_stiffness(cam, loads, faster) == pytest.approx(stiffness, rel=1e-5)


def test_jump_speed_of_an_eccentric_disk_is_that_of_the_closed_form():
    """The lift is e (1 - cos t), so contact is lost at the top when m e w2 exceeds preload + 2 e stiffness."""
    loads = FollowerLoads(gk.Mass(0.5), stiffness=2, preload=30)
    assert jump_speed(ECCENTRIC, loads) == pytest.approx(np.sqrt((30 + 2 * 12 * 2) / (0.5 * 0.012)), rel=1e-12)


def test_force_and_torque_of_an_eccentric_disk_are_those_of_its_centre():
    """The face is pressed on the disk above its centre, at a distance of e sin t from the axis."""
    angle, loads = np.linspace(0.1, 6, 7), FollowerLoads(gk.Mass(0.5), stiffness=2, preload=30)
    result = cam_forces(ECCENTRIC, loads, angle, speed=50.0)
    force = 30 + 2 * 12 * (1 - np.cos(angle)) + 0.5 * 0.012 * np.cos(angle) * 50**2
    assert result.contact == pytest.approx(force)
    assert result.torque == pytest.approx(force * 12 * np.sin(angle))


def test_nothing_keeps_a_follower_whose_velocity_jumps():
    assert jump_speed(JUMPING, SLIDING) == 0
    assert least_preload(JUMPING, SLIDING, 1.0) == least_stiffness(JUMPING, SLIDING, 1.0) == np.inf
    assert least_preload(JUMPING, SLIDING, 0) == least_stiffness(JUMPING, SLIDING, 0) == 0


@pytest.mark.parametrize(
    ("loads", "speed", "preload", "stiffness"),
    [
        ({}, 0, 0, 0),
        ({"force": 1e9}, 1e4, 0, 0),
        # Pulled off at lift 0, and only a preload helps.
        ({"force": -10}, 0, 10, np.inf),
    ],
)
def test_limits_of_the_spring_at_rest(loads, speed, preload, stiffness):
    follower = FollowerLoads(gk.Mass(0.5), **loads)
    assert least_preload(ECCENTRIC, follower, speed) == preload
    assert least_stiffness(ECCENTRIC, follower, speed) == stiffness
    if speed == 0:
        assert jump_speed(ECCENTRIC, follower) == 0


def test_a_follower_at_rest_or_without_mass_never_jumps():
    dwell = gk.Cam(gk.TranslatingRoller(10), gk.Program((gk.Dwell(end_deg=360),)), 40)
    assert jump_speed(dwell, SLIDING) == np.inf
    assert jump_speed(ECCENTRIC, FollowerLoads(gk.Mass(0), preload=1)) == np.inf


STEEL = gk.Material("steel", 7850, modulus=210_000, poisson_ratio=0.3)


@pytest.mark.parametrize(
    ("follower", "diameter"), [(gk.TranslatingFlat(), 80.0), (gk.TranslatingRoller(10), 80 * 20 / (80 + 20))]
)
def test_pressure_is_that_of_roark_for_equal_steel(follower, diameter):
    """Roark's Formulas for Stress and Strain, table of contact stresses: 0.591 sqrt(load per length x E / diameter)."""
    cam = gk.Cam(follower, gk.Program((gk.Dwell(end_deg=360),)), base_radius=40)
    result = cam_forces(cam, FollowerLoads(gk.Mass(0.4), preload=600), np.array([0.5, 2.0]), speed=10.0)
    assert result.pressure(8, STEEL) == pytest.approx(0.591 * np.sqrt(600 / 8 * 210_000 / diameter), rel=1e-3)


@pytest.mark.parametrize("name", ["roller, clockwise", "tilted, counterclockwise", "flat on arm, clockwise"])
def test_pressure_has_the_curvature_of_the_profile(name):
    """The radius is that of the circle through three neighbouring points of the profile."""
    cam, step = CAMS[name], 1e-4
    a, b, c = (cam.profile.point(MOVING + k * step) for k in (-1, 0, 1))
    area = np.imag(np.conj(b - a) * (c - a))
    # The profile runs against the rotation of the cam.
    curvature = -cam.sense * 2 * area / (np.abs(b - a) * np.abs(c - b) * np.abs(c - a))
    curvature = curvature + (1 / cam.follower.roller_radius if cam.follower.roller_radius else 0)
    result = cam_forces(cam, loads_of(cam), MOVING, speed=5.0)
    diameter = 2 / curvature
    expected = 0.5914 * np.sqrt(result.contact / 8 * 210_000 / diameter)
    assert result.pressure(8, STEEL) == pytest.approx(expected, rel=2e-4)


def test_pressure_is_unknown_at_a_knife_edge_and_zero_without_contact():
    knife = gk.Cam(gk.TranslatingRoller(0), LIFTS, 40)
    assert np.isnan(cam_forces(knife, SLIDING, MOVING, speed=1.0).pressure(8, STEEL)).all()
    lost = cam_forces(ECCENTRIC, FollowerLoads(gk.Mass(0.5), force=-5), MOVING, speed=0)
    assert (lost.contact < 0).all() and (lost.pressure(8, STEEL) == 0).all()


def test_loads_that_do_not_suit_the_follower_are_refused():
    arm = gk.Cam(gk.OscillatingRoller(10, 100, 80), SWINGS, 45)
    roller = gk.Cam(gk.TranslatingRoller(10), LIFTS, 45)
    cases = [
        (arm, GuideFriction(0.1, 40, 30), "loads.friction"),
        (roller, GuideFriction(0.1, 40, 19.9), "loads.friction.overhang"),
    ]
    for cam, friction, field in cases:
        loads = replace(SLIDING, friction=friction)
        calls = (
            lambda c, f: cam_forces(c, f, 0.0, speed=1.0),
            jump_speed,
            lambda c, f: least_preload(c, f, 1.0),
            lambda c, f: least_stiffness(c, f, 1.0),
        )
        for call in calls:
            with pytest.raises(gk.DesignError) as refused:
                call(cam, loads)
            assert refused.value.field == field
    with pytest.raises(gk.DesignError) as refused:
        FollowerLoads(gk.Mass(np.array([1.0, 2.0])))
    assert refused.value.field == "mass"
