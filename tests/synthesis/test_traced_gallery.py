"""The heart, the figure eight and the letter S of the gallery: how near they are, and that they can be cut."""

import json
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk

ROOT = Path(__file__).parent.parent.parent


def farthest(points, curve):
    """Largest distance of points from the chords of a closed curve, by brute force."""
    start, step = curve, np.roll(curve, -1) - curve
    along = np.clip((np.conj(step) * (points[:, None] - start)).real / np.abs(step) ** 2, 0, 1)
    return np.abs(points[:, None] - start - along * step).min(axis=1).max()


@pytest.mark.parametrize(("name", "percent"), [("traced-heart", 1), ("traced-eight", 1), ("traced-letter", 3)])
def test_traced_curves_are_near_both_ways_and_their_plates_pass_each_other(name, percent):
    """Wanted points are joined by their trigonometric polynomial; the path is that of the kept recipe alone."""
    found = ROOT / "out" / name / f"{name}.found.toml"
    recipe = gk.load(found if found.exists() else ROOT / "recipes" / f"{name}.toml")
    rows = np.loadtxt(ROOT / "recipes" / f"{name}.csv", delimiter=",", skiprows=1)
    wanted = rows[:, 0] + 1j * rows[:, 1]
    harmonics, half = np.fft.fft(wanted), len(wanted) // 2
    padded = np.concatenate([harmonics[:half], np.zeros(3 * len(wanted)), harmonics[half:]])
    curve = 4 * np.fft.ifft(padded)
    turn = np.linspace(0, 2 * np.pi, 721)[:-1]
    path = gk.move(recipe.linkage, turn, recipe.branch).point("coupler_point").position
    size = np.hypot(np.ptp(wanted.real), np.ptp(wanted.imag)) / 100
    assert max(farthest(wanted, path), farthest(path, curve)) < percent * size
    checks = {check["id"]: check for check in json.loads((ROOT / "out" / name / "summary.json").read_text())["checks"]}
    assert checks["collisions"]["value"] == 0 and checks["share_reached"]["value"] == 100
