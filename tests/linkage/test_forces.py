"""Inverse dynamics against published numbers, a multibody program's numbers, and Newton's laws body by body."""

import numpy as np
import pytest

import geomkin as gk
from tests.linkage import andrews
from tests.linkage.examples import ALL, FEW

GRAVITY = -9810j


def one(values):
    return np.asarray(values).item()


def four_bar(friction=()):
    motion = gk.move(gk.FourBar(100, 50, 151, 111), np.radians([120.0]), speed=95.0)
    masses = {
        "crank": gk.Mass(0.2, 20, 100.0),
        "coupler": gk.Mass(0.5, 75.5, 1210.0),
        "rocker": gk.Mass(0.4, 55.5, 910.0),
    }
    return gk.forces(motion, gk.Loads(GRAVITY, masses, friction=friction))


def pump(friction=()):
    linkage = gk.SliderCrank(40, 140, offset=10)
    motion = gk.move(linkage, np.radians([50.0]), speed=60.0, acceleration=-200.0)
    masses = {"crank": gk.Mass(0.3, 8, 90.0), "coupler": gk.Mass(0.45, 52, 900.0), "slider": gk.Mass(0.6, 15, 100.0)}
    return gk.forces(motion, gk.Loads(GRAVITY, masses, [gk.Force("slider", 30, -250)], friction=friction))


def quick_return():
    linkage = gk.InvertedSliderCrank(100, 40, origin=0j, ground_angle_deg=-90)
    motion = gk.move(linkage, np.radians([125.0]), speed=15.0)
    masses = {"crank": gk.Mass(0.1, 15, 40.0), "coupler": gk.Mass(0.05, 0, 8.0), "rocker": gk.Mass(0.4, 90, 2500.0)}
    return gk.forces(motion, gk.Loads(GRAVITY, masses, torques=[gk.Torque("rocker", -2000.0)]))


STEPHENSON = {
    "ground": {"O2": 0, "O4": 180, "O6": 260 + 60j},
    "crank": {"O2": 0, "A": 50},
    "coupler": {"A": 0, "B": 160, "P": 90 + 60j},
    "rocker": {"O4": 0, "B": 120},
    "link": {"P": 0, "C": 150},
    "output": {"O6": 0, "C": 110},
}


def stephenson(driver="crank", friction=()):
    if driver == "crank":
        motion = gk.move(gk.Linkage(STEPHENSON, "crank"), np.radians([70.0]), speed=20.0, acceleration=5.0)
    else:
        at = gk.move(gk.Linkage(STEPHENSON, "crank"), np.radians([70.0]))
        estimate = {pin: one(at.point(pin).position) for pin in "ABPC"}
        drive = np.angle(at["output"].direction)
        linkage = gk.Linkage(STEPHENSON, "output", estimate=estimate)
        motion = gk.move(linkage, drive, speed=-6.0, acceleration=3.0)
    masses = {
        "crank": gk.Mass(0.12, 20, 60.0),
        "coupler": gk.Mass(0.35, 80 + 20j, 900.0),
        "rocker": gk.Mass(0.2, 60, 260.0),
        "link": gk.Mass(0.18, 65, 270.0),
        "output": gk.Mass(0.25, 55 + 10j, 400.0),
    }
    forces = [gk.Force("coupler", "P", -30 + 10j)]
    return gk.forces(motion, gk.Loads(GRAVITY, masses, forces, [gk.Torque("output", 1500.0)], friction=friction))


def test_four_bar_agrees_with_a_multibody_program():
    result = four_bar()
    assert one(result.driver) == pytest.approx(-3521.164809164, rel=1e-12)
    expected = {
        ("crank_pivot", "crank"): 130.898510373 - 84.699078235j,
        ("crank_pin", "coupler"): 112.848510373 - 55.397561159j,
        ("rocker_pin", "rocker"): 31.780309492 + 109.922155970j,
        ("rocker_pivot", "rocker"): -12.050748787 - 164.019136982j,
    }
    for (pin, body), force in expected.items():
        assert one(result.pin(pin, on=body)) == pytest.approx(force, rel=1e-10)
    assert one(result.shaking_force) == pytest.approx(-118.847761586 + 259.509215217j, rel=1e-11)
    assert one(result.shaking_moment) == pytest.approx(20524.861718320, rel=1e-12)


def test_crossed_four_bar():
    motion = gk.move(gk.FourBar(100, 50, 151, 111), np.radians([120.0]), branch=-1, speed=95.0)
    assert one(gk.forces(motion, four_bar().loads).driver) == pytest.approx(53.215135429, rel=1e-9)


def test_pump_agrees_with_a_multibody_program():
    result = pump()
    assert one(result.driver) == pytest.approx(-6173.674821980, rel=1e-12)
    expected = {
        ("crank_pivot", "crank"): 153.784344391 - 54.383202810j,
        ("crank_pin", "coupler"): 158.970328006 - 50.399040769j,
        ("slider_pin", "slider"): 197.925112328 - 22.156919718j,
    }
    for (pin, body), force in expected.items():
        assert one(result.pin(pin, on=body)) == pytest.approx(force, rel=1e-10)
    slide = result.slide("slide")
    assert one(slide.normal) == pytest.approx(28.042919718, rel=1e-9)
    assert one(slide.moment) == pytest.approx(88.29, rel=1e-9)
    assert one(result.shaking_force) == pytest.approx(96.215655609 + 39.583783093j, rel=1e-10)
    assert one(result.shaking_moment) == pytest.approx(391.602710169, rel=1e-10)


def test_quick_return_agrees_with_a_multibody_program():
    result = quick_return()
    assert one(result.driver) == pytest.approx(563.794650137, rel=1e-11)
    slide = result.slide(result.motion.linkage.sliders[0].name)
    assert abs(one(slide.normal)) == pytest.approx(17.501341, rel=1e-6)
    assert abs(one(slide.moment)) == pytest.approx(0.189041, rel=1e-5)
    assert one(result.pin("crank_pivot", on="crank")) == pytest.approx(-17.556131 + 5.526845j, rel=1e-6)
    assert one(result.pin("rocker_pivot", on="rocker")) == pytest.approx(15.968343 - 0.816887j, rel=1e-6)


def test_six_bar_agrees_with_a_multibody_program_whichever_body_drives():
    result = stephenson()
    expected = {
        ("O2", "crank"): 29.739271 + 15.208644j,
        ("A", "coupler"): 30.078887 + 14.929445j,
        ("B", "rocker"): -5.100142 + 25.085303j,
        ("O4", "rocker"): 3.616685 - 23.808234j,
        ("P", "link"): 9.532093 + 1.222698j,
        ("C", "output"): 12.524024 + 1.824783j,
        ("O6", "output"): -14.476163 - 1.123260j,
    }
    for (pin, body), force in expected.items():
        assert one(result.pin(pin, on=body)) == pytest.approx(force, rel=1e-6)
    assert one(result.driver) == pytest.approx(-1149.344318911, rel=1e-11)
    driven = stephenson("output")
    assert one(driven.driver) == pytest.approx(-6495.993465744, rel=1e-10)
    assert one(driven.pin("O2", on="crank")) == pytest.approx(-8.174081 - 22.250438j, rel=1e-6)
    assert one(driven.pin("O6", on="output")) == pytest.approx(45.888005 + 8.404277j, rel=1e-6)


@pytest.mark.parametrize("case, torque", [(four_bar, -3300.089092399), (stephenson, -1089.835214511)])
def test_dry_friction_of_pins(case, torque):
    pins = case().motion.linkage.pins
    result = case(friction=[gk.PinFriction(pin, 0.15, 4.0) for pin in pins])
    assert one(result.driver) == pytest.approx(torque, rel=1e-9)


def test_dry_friction_of_pins_and_a_slide():
    friction = [gk.PinFriction(p, 0.15, 4.0) for p in ("crank_pivot", "crank_pin", "slider_pin")]
    result = pump([*friction, gk.SlideFriction("slide", 0.12, 40.0)])
    assert one(result.driver) == pytest.approx(-5834.924490098, rel=1e-11)
    assert one(result.slide("slide").normal) == pytest.approx(26.038650734, rel=1e-9)
    assert one(result.slide("slide").moment) == pytest.approx(204.494050675, rel=1e-9)


def loaded(linkage, seed):
    """Random masses on all bodies, a force, a torque, a spring and gravity."""
    rng, size = np.random.default_rng(seed), float(np.max(linkage.size))
    bodies = [body for body in linkage.bodies if body != linkage.ground]

    def somewhere():
        return size * complex(*rng.uniform(-1, 1, 2))

    masses = {body: gk.Mass(rng.uniform(0.1, 1), somewhere(), rng.uniform(0.1, 1) * size**2) for body in bodies}
    force = gk.Force(rng.choice(bodies).item(), somewhere(), complex(*rng.uniform(-50, 50, 2)))
    torque = gk.Torque(rng.choice(bodies).item(), rng.uniform(-20, 20) * size)
    spring = gk.Spring(rng.choice(bodies).item(), somewhere(), linkage.ground, 9 * size, 5 / size, size, 3.0)
    return gk.Loads(GRAVITY * 1e-3 * size, masses, [force], [torque], springs=[spring])


def newton_euler(result):
    """Largest missing force, N, and moment about the centre, N mm, of any body, and the largest single force."""
    motion, loads, linkage = result.motion, result.loads, result.motion.linkage
    missing, largest = [], [np.zeros(motion.assembled.shape)]
    for name, body in motion.bodies.items():
        if name == linkage.ground:
            continue
        mass = loads.masses[name]
        centre = body.point(mass.centre)
        acting = [(centre.position, 1e-3 * mass.mass * loads.gravity + 0 * centre.position)]
        for pin, bodies in linkage.pins.items():
            if name in bodies:
                acting.append((body.point(linkage.bodies[name][pin]).position, result.pin(pin, on=name)))
        moment = -1e-3 * mass.inertia * body.alpha
        for slider in linkage.sliders:
            line = motion.bodies[slider.along].direction * slider.direction
            place = motion.bodies[slider.body].point(slider.point).position
            if name in (slider.body, slider.along):
                sign, press = 1 if name == slider.body else -1, result.slide(slider.name)
                acting.append((place, sign * 1j * line * press.normal))
                moment = moment + sign * press.moment
                if slider is linkage.driven_slider:
                    acting.append((place, sign * line * result.driver * (-1 if linkage.driver == slider.along else 1)))
        if name == linkage.driver and linkage.driven_slider is None:
            moment = moment + result.driver
        for force in loads.forces:
            if force.body == name:
                acting.append((body.point(force.point).position, force.force))
        for torque in loads.torques:
            moment = moment + torque.torque * (torque.body == name)
        for spring in loads.springs:
            if spring.body == name:
                here = body.point(spring.point).position
                there = motion.bodies[linkage.ground].point(spring.to_point).position
                length = abs(there - here)
                pull = spring.stiffness * (length - spring.free_length) + spring.preload
                acting.append((here, pull * (there - here) / length))
        force = sum(each for _, each in acting) - 1e-3 * mass.mass * centre.acceleration
        moment = moment + sum(np.imag(np.conj(place - centre.position) * each) for place, each in acting)
        missing += [abs(force), abs(moment) / float(np.max(linkage.size))]
        largest += [abs(each) + np.zeros(len(force)) for _, each in acting]
    return np.max(missing, axis=0), np.max(largest, axis=0)


def holds_for(name, seed):
    linkage, drive, branch = ALL[name]
    general = linkage.linkage
    motion = gk.move(general, drive, branch, speed=3.0, acceleration=-4.0)
    missing, largest = newton_euler(gk.forces(motion, loaded(general, seed)))
    known = motion.assembled & (motion.error_amplification < 1e3)
    assert known.any() and (missing[known] <= 1e-10 * largest[known] * motion.error_amplification[known] ** 2).all()


@pytest.mark.parametrize("name", FEW)
def test_every_body_obeys_newton_and_euler(name):
    """The driver follows from virtual power, the joint forces from the equations: together they balance each body."""
    holds_for(name, 1)


@pytest.mark.campaign
@pytest.mark.parametrize("name", ALL)
def test_every_body_obeys_newton_and_euler_under_many_loads(name):
    for seed in range(10):
        holds_for(name, seed)


def test_seven_body_mechanism_of_andrews():
    """Published: the accelerations at rest under 0.033 N m; so the driver needs this torque for that acceleration."""
    linkage, branch = andrews.start()
    motion = gk.move(linkage, [andrews.BETA], branch, speed=0.0, acceleration=14222.4439199541)
    angles = [one(np.angle(motion[body].direction)) for body in ("K3", "K5", "K7")]
    assert angles == pytest.approx([andrews.GAMMA, andrews.DELTA, andrews.EPSILON], abs=1e-13)
    assert one(motion["K2"].alpha - motion["K1"].alpha) == pytest.approx(-10666.8329399656, rel=1e-12)
    result = gk.forces(motion, andrews.LOADS)
    assert one(result.driver) == pytest.approx(andrews.TORQUE, rel=1e-12)
    assert one(result.pin("E", on="K3")) == pytest.approx(98.5668703962411 - 6.1226883442557j, rel=1e-10)
    # The other two bodies at this pin are still at rest, and unloaded.
    assert abs(one(result.pin("E", on="K4"))) + abs(one(result.pin("E", on="K6"))) < 1e-9
