"""Times the search for the stack of plates, and adds it to timings.csv. Never pass or fail.

.venv/bin/python tests/speed/stacks.py

The floor of what meets: each pair by itself, looked at exactly on every step. Of the whole search: the same, so that it
shows what the rest adds. CPU time, the least of many.
"""

import sys
from pathlib import Path

import numpy as np
from engine import least_ms
from timings import keep

sys.path.insert(0, str(Path(__file__).parent.parent.parent))  # for the mechanisms of the tests

import geomkin as gk
from geomkin.linkage.parts import layers
from geomkin.linkage.parts.collisions import meeting, relative_paths
from geomkin.linkage.parts.plates import LinkStock, assemble
from geomkin.linkage.parts.stack import stack_links
from tests.linkage.mechanisms import JANSEN_LEG


def legs(frames):
    """Two legs of Jansen's on one crank, one turned over: 13 plates that move."""
    one = JANSEN_LEG.bodies
    bodies = {**one, "ground": {**one["ground"], "pivot_2": 38 - 7.8j}}
    for name in ("upper", "lower", "triangle", "link", "side", "foot"):
        points = {p if p == "crank_pin" else f"{p}_2": np.conj(z) for p, z in one[name].items()}
        bodies[f"{name}_2"] = points
    sides = {"c": -1, "d": 1, "f": -1, "c_2": 1, "d_2": -1, "f_2": 1}
    return gk.move(gk.Linkage(bodies, driver="crank"), np.linspace(0, 2 * np.pi, frames), sides)


def searches():
    cases = [("two walking legs", legs(361)), ("two walking legs in tenths of a degree", legs(3601))]
    for path in ("walking-leg", "sieve", "cognates"):
        recipe = gk.load(Path(__file__).parents[2] / "recipes" / f"{path}.toml")
        cases.append((path, recipe.figure if path == "cognates" else recipe.made.fine_motion))
    stock, seen = LinkStock(), []

    def noted(motion, pairs):
        seen.append(pairs)
        return meeting(motion, pairs)

    for name, motion in cases:
        seen.clear()
        layers.meeting = noted
        _ = layers.Meetings(motion, stock, assemble(motion, stock)).plates
        layers.meeting = meeting
        (pairs,) = seen

        def by_themselves(motion=motion, pairs=pairs):
            return [(relative_paths(motion, p.body, p.other, p.places).gap(p.corners) < p.near).any() for p in pairs]

        assert by_themselves() == meeting(motion, pairs).tolist()
        runs = 3 if len(motion.drive) > 1000 else 9
        floor = least_ms(by_themselves, runs)
        ours = least_ms(lambda motion=motion, pairs=pairs: meeting(motion, pairs), 5 * runs)
        whole = least_ms(lambda motion=motion: stack_links(motion, stock), runs)
        yield f"stack: {name}, which of {len(pairs)} pairs meet in {len(motion.drive)} frames", ours, floor
        yield f"stack: {name}, the whole search", whole, floor


if __name__ == "__main__":
    keep(searches)
