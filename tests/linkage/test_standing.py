"""How walkers stand: support polygons against shapely, resting planes against linear programming, and recipes."""

import re
from dataclasses import replace
from pathlib import Path

import highspy
import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.linkage.measures import ground_slopes, support_margin

WALKER = (Path(__file__).parent.parent.parent / "recipes" / "walker.toml").read_text("utf-8")
# Without masses the weight is in the middle.
WALKER = WALKER.replace('material = "birch-plywood"\n', "").replace("[loads]\n", "")
HEAD, STOCK = WALKER.split("[[copies]]")[0], "[stock]" + WALKER.split("[stock]")[1]


def walker(*copies, foot="foot", step=10):
    """A walker of Jansen's legs. copies: phase and whether mirrored."""
    tables = (f"[[copies]]\nphase_deg = {phase}\nmirrored = {str(turned).lower()}\n" for phase, turned in copies)
    head = HEAD.replace("kind =", f'foot = "{foot}"\nkind =').replace("step_deg = 2", f"step_deg = {step}")
    return gk.load(head + "\n".join(tables) + STOCK)


@pytest.fixture(scope="module")
def cases():
    """Feet seen from above, shape (5, 60), heights, and the centre, which is not always among them."""
    rng = np.random.default_rng(5)
    feet = rng.normal(size=(5, 60)) + 1j * rng.normal(size=(5, 60))
    return feet, rng.normal(size=(5, 60)), 0.2 + 0.1j


def test_support_margin_is_the_distance_to_the_edge_of_the_hull(cases):
    feet, _, centre = cases
    margin = support_margin(feet, centre)
    point = shapely.Point(centre.real, centre.imag)
    hulls = [shapely.MultiPoint(np.c_[z.real, z.imag]).convex_hull for z in feet.T]
    inside = np.array([hull.contains(point) for hull in hulls])
    distance = np.array([hull.exterior.distance(point) for hull in hulls])
    assert 10 < inside.sum() < 50 and ((margin > 0) == inside).all()
    assert margin[inside] == pytest.approx(distance[inside])


def highest_plane_below(feet, height, centre):
    """Slope of the plane below all feet that is highest at the centre, by linear programming."""
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    along, across, level = (solver.addVariable(lb=-np.inf) for _ in range(3))
    for z, y in zip(feet, height):
        solver.addConstr(z.real * along + z.imag * across + level <= y)
    solver.maximize(centre.real * along + centre.imag * across + level)
    return complex(solver.val(along), solver.val(across))


def test_frame_rests_on_the_highest_plane_below_all_feet(cases):
    feet, height, centre = cases
    slopes = ground_slopes(feet, height, centre)
    assert (np.isnan(slopes) == (support_margin(feet, centre) < 0)).all()
    for z, y, slope in zip(feet.T, height.T, slopes):
        if np.isfinite(slope):
            assert slope == pytest.approx(highest_plane_below(z, y, centre), abs=1e-7)


@pytest.mark.campaign
def test_six_legs_of_alternating_phase_rock_little_and_four_stand_on_two_feet_at_times():
    opposite = [(0, True), (180, False), (180, True)]
    four, six = walker(*opposite), walker(*opposite, (0, False), (0, True))
    for recipe, rocks in ((four, True), (six, False)):
        checks = {check.id: check for check in recipe.checks}
        assert checks["support_margin"].passed and len(recipe.remarks) == 1 + rocks
        assert checks["tilt_across"].passed == checks["tilt_along"].passed == (not rocks)
        stance = recipe.aspect("foot").stance
        # The same from the back: the copies are arranged as in a mirror.
        assert stance.feet.imag + stance.feet.imag[::-1] == pytest.approx(2 * stance.centre.imag)
        # Also between two positions, whatever the rows of the table.
        least = recipe.notes["stance"]["least_margin_mm"]
        assert stance.margin.min() - 0.1 < least < stance.margin.min()
        coarse = replace(recipe, drive=replace(recipe.drive, step_deg=45)).notes["stance"]["least_margin_mm"]
        assert coarse == pytest.approx(least, rel=1e-9)
    # Of four feet the lowest two are at opposite corners, and the centre is above the line between them.
    low = np.argsort(four.aspect("foot").stance.height, axis=0)[:2]
    pairs = np.take_along_axis(four.aspect("foot").stance.feet, low, axis=0) - four.aspect("foot").stance.centre
    off = abs((pairs[0] * pairs[1].conj()).imag) / abs(pairs[0] - pairs[1])
    assert off.min() < 1e-6


@pytest.mark.campaign
def test_copies_advised_to_four_legs_let_them_rock_little():
    text = WALKER.replace("kind =", 'foot = "foot"\nkind =').replace("step_deg = 2", "step_deg = 10")
    advice = next(check.advice for check in gk.load(text).checks if check.id == "tilt_along")
    copies = re.search(r"copies = \[.*\]", advice)[0]
    first, last = text.index("[[copies]]"), text.index("[stock]")
    six = gk.load(f"{copies}\n{text[:first]}{text[last:]}")
    assert len(six.copies) == 5
    assert all(check.passed for check in six.checks if check.id.startswith("tilt"))


def test_walker_on_three_feet_in_phase_falls_over_and_without_rods_its_stance_is_unknown():
    falling = walker((0, True), (0, False))
    checks = {check.id: check for check in falling.checks}
    assert not checks["support_margin"].passed and checks["support_margin"].value < 0
    assert np.isnan(checks["tilt_along"].value) and "tilt_along_deg" not in falling.notes["stance"]
    unknown = walker((0, False), (180, False))
    assert unknown.aspect("foot").stance is None and len(unknown.remarks) == 1 and "stance" not in unknown.notes
    assert not {"support_margin", "tilt_along"} & {check.id for check in unknown.checks}


@pytest.mark.parametrize(("foot", "copies"), [("hoof", 3), ("F", 3), ("foot", 1)])
def test_foot_that_cannot_stand_is_refused(foot, copies):
    with pytest.raises(gk.RecipeError) as refused:
        walker(*(copies * [(0, True)]), foot=foot)
    assert refused.value.problems[0].key == "foot"
