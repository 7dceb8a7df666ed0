"""Corners and gaps that a beam does not reach, against closed forms, the written outline and a rolling disk."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.model.machinability import beam_check
from geomkin.verification.read_back import read_svg

CASE = Path(__file__).parent.parent / "cases" / "kerf-near-root-gap.toml"
TOLERANCE = 0.005


def plate(*corners, holes=()):
    return gk.Part("plate", gk.plane.Polyline(np.array(corners)), holes, 3.0)


def slotted(width):
    left, right = 10 - width / 2, 10 + width / 2
    return plate(0, 20, 20 + 20j, right + 20j, right + 15j, left + 15j, left + 20j, 20j)


def notched(angle_deg):
    """A plate with a notch of this angle, its point at (10, 5)."""
    half = 4 * np.tan(np.radians(angle_deg) / 2)
    return plate(0, 20, 20 + 9j, 10 + half + 9j, 10 + 5j, 10 - half + 9j, 9j)


@pytest.mark.parametrize("angle_deg", [60, 80, 91, 120])
def test_beam_leaves_the_rest_of_a_corner(angle_deg):
    """A disk of radius r in a corner stays r (1 / sin(half) - 1) off its point; up to a right angle that is accepted."""
    check = beam_check(notched(angle_deg), 1.0, TOLERANCE)
    exact = 0.5 * (1 / np.sin(np.radians(angle_deg) / 2) - 1)
    assert check.value == pytest.approx(exact, abs=TOLERANCE / 2)
    assert check.passed == (angle_deg > 88)


@pytest.mark.parametrize("width, enters", [(1.01, True), (0.99, False)])
def test_beam_enters_no_slot_narrower_than_itself(width, enters):
    check = beam_check(slotted(width), 1.0, TOLERANCE)
    assert check.passed == enters
    # In front of the slot the disk touches both of its edges.
    sunk = 0.5 - np.sqrt(0.5**2 - min(width / 2, 0.5) ** 2)
    assert check.value == pytest.approx(0.5 * (np.sqrt(2) - 1) if enters else 5 - sunk, abs=0.03)


def test_holes_count_too():
    square = gk.plane.Polyline(np.array([5 + 5j, 9 + 5j, 9 + 9j, 5 + 9j]))
    round_hole = gk.plane.Circle(7 + 7j, 2)
    assert beam_check(plate(0, 20, 20 + 20j, 20j, holes=(square,)), 1.0, TOLERANCE).passed
    assert beam_check(plate(0, 20, 20 + 20j, 20j, holes=(round_hole,)), 1.0, TOLERANCE) is None


def test_root_gap_hardly_wider_than_the_kerf(tmp_path):
    """What is left of the roots, measured on the written path: a disk follows it and leaves the roots shallower."""
    recipe = gk.load(CASE)
    gk.write(recipe, tmp_path / "gear.svg")
    written = next(
        line.outline for line in read_svg((tmp_path / "gear.svg").read_bytes(), 1e-4).lines if line.layer == "CUT"
    )
    z = written.points - written.centroid
    left = shapely.Polygon(np.column_stack([z.real, z.imag])).buffer(-1.1 / 2, quad_segs=64).exterior
    roots = np.abs(recipe.design.outline.point(np.linspace(*recipe.design.outline.breaks[[0, -1]], 20_001))).min()
    shallower = left.distance(shapely.Point(0, 0)) - roots
    assert shallower == pytest.approx(0.101, abs=0.002)
    check = next(check for check in recipe.checks if check.id == "beam_gear")
    assert not check.passed and shallower < check.value < 1.1 * shallower
    narrower = replace(recipe, files=replace(recipe.files, kerf=0.7))
    assert all(check.passed for check in narrower.checks)


def test_certificate_agrees_with_the_check(tmp_path):
    recipe = gk.load(CASE)
    gk.make(replace(recipe, files=replace(recipe.files, write=("svg",))), tmp_path, ["svg"])
    (certificate,) = gk.verify(tmp_path)
    assert [file.format for file in certificate.files if not file.passed] == ["svg"]
