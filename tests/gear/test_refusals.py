"""Refusals of gears word by word, and what they advise tried."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

import geomkin as gk

from .test_ring import cutting


def test_tips_of_a_ring_that_no_involute_reaches_are_told_with_what_would_help():
    rng, at_most, larger = np.random.default_rng(1), 0, 0
    while min(at_most, larger) < 10:
        cutter_teeth = int(rng.integers(4, 60))
        teeth = max(8, cutter_teeth + int(rng.integers(1, 60)))
        angle, height, own = float(rng.choice([14.5, 20, 30])), float(rng.uniform(0.5, 2)), float(rng.uniform(-2, 2))
        shift, addendum = float(rng.uniform(-4, 4)), round(float(rng.uniform(0.01, 1)), 3)
        try:
            cutter = gk.gear.PinionCutter(cutter_teeth, angle, height, 0.0, own)
            gk.RingGear(teeth, 2, shift, cutter, addendum)
            continue
        except gk.DesignError as error:
            refused = error
        if "makes involutes" not in refused.problem:
            continue
        made = SimpleNamespace(teeth=teeth, module=2, profile_shift=shift, cutter=cutter, addendum=addendum)
        base = [z * np.cos(np.radians(angle)) for z in (teeth, cutter_teeth)]
        # Where the line of action touches the cutter's base circle.
        line = np.sqrt(cutting(made) ** 2 - (base[0] - base[1]) ** 2)
        least, tip = np.hypot(base[0], line), 2 * (teeth / 2 + shift - addendum)
        assert refused.field == "addendum" and refused.problem == (
            f"found {addendum:g}, so the tips stand at {tip:.5g} mm, but a cutter of {cutter_teeth} teeth makes "
            f"involutes from {least:.5g} mm outwards"
        )
        room = teeth / 2 + shift - least / 2
        if room < 1e-3:
            assert refused.remedy == "give a larger profile_shift or cutter teeth"
            larger += 1
            continue
        named = re.fullmatch(r"give at most ([\d.e-]+) modules, or more profile_shift or cutter teeth", refused.remedy)
        assert float(named[1]) == pytest.approx(room, rel=1e-4)
        at_most += 1
