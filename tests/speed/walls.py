"""Prints the thinnest wall of every part of the gallery, the least it should have, and what that costs to work out.

.venv/bin/python tests/speed/walls.py [RECIPE ...]
"""

import sys
import time
from pathlib import Path

import geomkin as gk
from geomkin.model.machinability import least_wall

RECIPES = Path(__file__).parent.parent.parent / "recipes"


def main(names):
    print(f"{'recipe':<24} {'part':<24} {'wall, mm':>9} {'least':>9} {'ms':>9}")
    for name in names or sorted(path.stem for path in RECIPES.glob("*.toml")):
        recipe = gk.load(RECIPES / f"{name}.toml")
        parts = {part.name: part for part in recipe.parts}
        start = time.process_time()
        walls = recipe.walls
        cost = 1000 * (time.process_time() - start)
        for part, wall in walls.items():
            limit = least_wall(parts[part].thickness, recipe.files.kerf)
            print(f"{name:<24} {part:<24} {wall:>9.4g} {limit:>9.4g} {cost:>9.0f}")
            cost = 0.0


if __name__ == "__main__":
    main(sys.argv[1:])
