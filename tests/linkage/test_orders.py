"""Bodies and sliders may be listed in any order: the plan finds the same motion."""

from itertools import permutations, product

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.moving import plan
from geomkin.linkage.solve.loops import Loops

# A four-bar whose coupler point moves a rod in a pivoted cylinder: no pin of these two stands before the four-bar does.
CYLINDER = gk.Linkage(
    {
        "ground": {"O": 0, "C": 100, "E": 60 + 150j},
        "crank": {"O": 0, "A": 30},
        "cylinder": {"E": 0},
        "rod": {"P": 0, "end": -90},
        "coupler": {"A": 0, "B": 90, "P": 40 + 25j},
        "rocker": {"C": 0, "B": 70},
    },
    "crank",
    (gk.Slider("stroke", "rod", "cylinder"),),
)
# A shaper with its ram on a rail: a slot, a bar from its end, a slide.
SHAPER = gk.Shaper(90, 30, 180, 60, 85, origin=3j).linkage
# A crank that slides a plate along a moving lever's rail and a fixed one.
YOKE = gk.ScotchYoke(30, 100, 70).linkage


@pytest.mark.parametrize("linkage", [CYLINDER, SHAPER, YOKE], ids=["cylinder", "shaper", "yoke"])
def test_every_order_of_bodies_and_sliders_gives_the_same_motion(linkage):
    drive = np.array([0.7, 2.0])
    before = gk.move(linkage, drive)
    assert before.assembled.all()
    ground, *others = linkage.bodies
    for order in permutations(others):
        bodies = {name: linkage.bodies[name] for name in (ground, *order)}
        for sliders in permutations(linkage.sliders):
            same = gk.Linkage(bodies, linkage.driver, sliders, linkage.origin, linkage.ground_angle_deg)
            assert not any(isinstance(step, Loops) for step in plan(same))
            joints = gk.move(same, drive).branches
            # Which side is left depends on which body comes first: one of the branches is the same motion.
            apart = []
            for signs in product((1, -1), repeat=len(joints)):
                motion = gk.move(same, drive, dict(zip(joints, signs)))
                assert np.nanmax(motion.residual, initial=0.0) < 1e-10
                apart.append(max(np.abs(motion.bodies[b].direction - before.bodies[b].direction).max() for b in bodies))
            assert np.nanmin(apart) < 1e-12, order
