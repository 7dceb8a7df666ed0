"""Whether pins and plates hold: stresses by hand, by the other side of each section, and by shapely."""

import dataclasses
from itertools import permutations

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.linkage.parts.strength import plate_loads, plate_sections, plate_stress

STEEL = gk.linkage.LinkStock(thickness=4, bar_width=16, pin_diameter=5, material=gk.making.material("steel-S235"))


def values(result, stock=STEEL, stack=None):
    return {check.id: check for check in gk.linkage.linkage_strength_checks(result, stock, stack)}


@pytest.mark.parametrize(("pull", "stress"), [(1, 100 / (4 * 10.8)), (1j, 100 * 30 * 6 * 16 / (4 * (16**3 - 5.2**3)))])
def test_a_bar_is_stretched_or_bent_across_its_hole(pull, stress):
    """A crank of 30 mm: 100 N along it over the net section, 100 N across it by the bending of that section."""
    motion = gk.move(gk.FourBar(100, 30, 90, 70), [0.7], speed=0.0)
    force = gk.Force("crank", "crank_pin", 100 * pull, frame="body")
    checks = values(gk.forces(motion, gk.Loads(forces=[force])))
    assert checks["plate_stress"].value == pytest.approx(stress, rel=1e-3)
    # Screws M5 in single shear, over the core of the thread (ISO 724: 4.019 mm); the pressure over its diameter.
    assert checks["pin_shear"].value == pytest.approx(100 / (np.pi / 4 * 4.019**2), rel=1e-3)
    assert checks["pin_pressure"].value == pytest.approx(100 / (5 * 4))
    assert all(check.passed for check in checks.values())


def six_bar(frames=37):
    """A loaded six-bar with a ternary plate, springs and inertia."""
    four_bar = gk.FourBar(100, 30, 90, 70, coupler_point=40 + 35j)
    linkage = gk.StephensonSixBar(four_bar, link=90, output=60, output_pivot=120 + 90j)
    drive = np.linspace(0, 2 * np.pi, frames)
    motion = gk.move(linkage, drive, speed=15.0)
    masses = {name: gk.Mass(0.1, 20 + 5j, 80) for name in ("crank", "coupler", "rocker", "link", "output")}
    spring = gk.Spring("rocker", 30 + 4j, "ground", 0j, stiffness=0.5)
    torsion = gk.TorsionSpring("output", "coupler", stiffness=300)
    forces = [gk.Force("coupler", 20 + 10j, 30 - 20j), gk.Force("link", 30, 5j)]
    return gk.forces(motion, gk.Loads(-9810j, masses, forces, springs=[spring, torsion]))


def test_stresses_are_those_of_the_other_side_of_each_section():
    """The forces on the near side of each section, and its area and inertia from a thin strip cut by shapely."""
    result = six_bar()
    motion, largest = result.motion, []
    stack, loads = gk.linkage.stack_links(motion, STEEL), plate_loads(result)
    for part in gk.linkage.link_parts(motion, STEEL, stack):
        if part.body in ("", "ground"):
            continue
        outline, *holes = (
            shapely.Polygon([(z.real, z.imag) for z in gk.flatten(curve, 1e-3)])
            for curve in (part.outline, *part.holes)
        )
        plate = outline.difference(shapely.union_all(holes))
        worst = np.zeros(37)
        turn = np.conj(motion.bodies[part.body].direction)
        forces = [(place, force * turn) for place, force in loads.acting[part.body]]
        for one, other in permutations(stack.plates[part.name].centres.tolist(), 2):
            axis = (other - one) / abs(other - one)
            for share in np.arange(8) / 8:
                place = one + share * (other - one)
                ends = [
                    place + side * 1e3j * axis + along * 1e-4 * axis
                    for side, along in ((-1, -1), (1, -1), (1, 1), (-1, 1))
                ]
                strip = plate.intersection(shapely.Polygon([(z.real, z.imag) for z in ends]))
                middle = complex(strip.centroid.x, strip.centroid.y)
                bounds = [shapely.get_coordinates(piece).view(complex)[:, 0] for piece in shapely.get_parts(strip)]
                across = [((z - middle) / axis).imag for z in bounds]
                area = 4 * strip.area / 2e-4
                inertia = 4 * sum((s.max() ** 3 - s.min() ** 3) / 3 for s in across)
                normal = moment = 0
                for at, force in forces:
                    where = ((at - place) / axis).real + 0 * np.zeros(37)
                    toward = (force / axis).real + np.zeros(37)
                    near = (where < -1e-6) | ((np.abs(where) < 1e-6) & (toward <= 0))
                    normal = normal + near * toward
                    moment = moment + near * (np.conj(at - middle) * force).imag
                for at, couple in loads.couples[part.body]:
                    moment = moment + (((at - place) / axis).real < 1e-6) * couple
                outermost = max(np.abs(s).max() for s in across)
                stress = np.abs(normal) / area + np.abs(moment) * outermost / inertia
                worst = np.maximum(worst, stress)
        found = plate_stress(loads, part.body, plate_sections(part, stack.plates[part.name].centres, 1e-3))
        assert found == pytest.approx(worst, rel=2e-3, abs=1e-4 * worst.max())
        largest.append(worst.max())
    # The largest is between two of these frames.
    assert 0 <= values(result, stack=stack)["plate_stress"].value / max(largest) - 1 < 0.01


def test_shear_of_a_pin_is_that_of_the_plates_above_each_joint():
    result = six_bar(721)
    stack = gk.linkage.stack_links(result.motion, STEEL)
    shears = []
    for pin in stack.pins:
        for layer in range(pin.first, pin.last):
            above = [stack.plates[name].body for name in pin.holes if stack.layers[name] > layer]
            shears.append(np.abs(sum(result.pin(pin.name, body) for body in above)).max())
    assert len(shears) > 6
    area = np.pi / 4 * (5 - 1.2269 * 0.8) ** 2
    assert values(result, stack=stack)["pin_shear"].value == pytest.approx(max(shears) / area, rel=1e-4)


def test_a_pressure_of_a_thousand_times_the_limit_asks_for_the_units():
    motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 6, 20), speed=0.0)
    for force, is_unit in ((2e3, False), (2e6, True)):
        checks = values(gk.forces(motion, gk.Loads(forces=[gk.Force("rocker", "rocker_pin", -1j * force)])))
        assert not checks["pin_pressure"].passed and ("unit" in checks["pin_pressure"].advice) == is_unit
    # Without a material, limits of pressure and stress are unknown.
    plain = dataclasses.replace(STEEL, material=None)
    result = gk.forces(motion, gk.Loads(forces=[gk.Force("rocker", "rocker_pin", -1j)]))
    assert set(values(result, plain)) == {"pin_shear"}
