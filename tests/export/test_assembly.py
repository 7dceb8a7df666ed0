"""Stills of the assembly read back: holes under their transforms against the motion's table and each other."""

import dataclasses
import io
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.export.still import within
from tests.export.stills import SPACE, loops, placed, root_of, titled

RECIPES = Path(__file__).parents[2] / "recipes"


def at(recipe, drive):
    return dataclasses.replace(recipe, files=dataclasses.replace(recipe.files, assembly_at=drive))


def made(recipe, folder, ending):
    (file,) = gk.write(recipe, folder / f"x-assembly.{ending}")
    return file.read_bytes()


def drawing(recipe, folder):
    document = ezdxf.read(io.StringIO(made(recipe, folder, "dxf").decode()))
    assert not document.audit().errors and document.header["$INSUNITS"] == 4
    return document.modelspace()


def holes(space, body):
    return [complex(c.dxf.center.x, c.dxf.center.y) for c in space.query(f'CIRCLE[layer=="BODY {body}"]')]


def pins_of_crank_rocker(recipe, drive):
    """By the table: both ends of the coupler, and its point."""
    row = int(np.argmin(np.abs(recipe.table["crank_angle_deg"] - drive)))
    crank_pin = recipe.linkage.crank * np.exp(1j * np.radians(recipe.table["crank_angle_deg"][row]))
    coupler = np.exp(1j * np.radians(recipe.table["coupler_angle_deg"][row]))
    point = recipe.table["coupler_point_x_mm"][row] + 1j * recipe.table["coupler_point_y_mm"][row]
    return crank_pin, crank_pin + recipe.linkage.coupler * coupler, point


@pytest.mark.parametrize("drive", [77.0, 251.0])
def test_holes_are_where_the_table_says_in_both_formats(drive, tmp_path):
    recipe = at(gk.load(RECIPES / "crank-rocker.toml"), drive)
    crank_pin, rocker_pin, point = pins_of_crank_rocker(recipe, drive)
    wanted = {
        "ground": [0, recipe.linkage.ground],
        "crank": [0, crank_pin],
        "coupler": [crank_pin, rocker_pin, point],
        "rocker": [rocker_pin, recipe.linkage.ground],
    }
    space, root = drawing(recipe, tmp_path), root_of(made(recipe, tmp_path, "svg"))
    for body, pins in wanted.items():
        found = holes(space, body)
        assert len(found) == len(pins) and all(min(abs(z - pin) for z in found) < 1e-6 for pin in pins)
        group = titled(root, body)
        set_there = placed(group.get("transform"))
        (outline,), circles = loops(group.find(f"{SPACE}path").get("d"))
        centres = [set_there(centre) for centre, _ in circles]
        assert all(min(abs(z - pin) for z in centres) < 0.02 for pin in pins)
        assert within(set_there(outline), np.array(pins, dtype=complex)).all()
    for pin in (crank_pin, rocker_pin):
        groups = [group for group in root.iter(f"{SPACE}g") if "scale(" not in group.get("transform", "")]
        assert any(abs(placed(group.get("transform"))(0) - pin) < 0.02 for group in groups)


def test_the_leg_s_plates_share_their_pins_and_keep_their_lengths(tmp_path):
    space = drawing(gk.load(RECIPES / "walking-leg.toml"), tmp_path)
    wanted = {"upper_rod": 50, "lower_rod": 61.9, "link": 39.3, "parallel": 39.4, "crank": 15}
    for body, length in wanted.items():
        one, other = holes(space, body)
        assert abs(abs(one - other) - length) < 1e-5
    for first, second in (("crank", "lower_rod"), ("lower_rod", "link"), ("link", "leg"), ("triangle", "parallel")):
        assert min(abs(a - b) for a in holes(space, first) for b in holes(space, second)) < 1e-5


def test_arcs_are_kept_and_nothing_is_scaled(tmp_path):
    recipe = gk.load(RECIPES / "crank-rocker.toml")
    space = drawing(recipe, tmp_path)
    (rocker,) = space.query('LWPOLYLINE[layer=="BODY rocker"]')
    # Two half circles and two straight edges: as many vertices, and the width of the bar between the latter.
    assert len(rocker) in (4, 6) and any(bulge for *_, bulge in rocker.get_points("xyb"))
    area = gk.area(next(part for part in recipe.parts if part.name == "rocker").outline)
    points = np.array([complex(v.x, v.y) for v in ezdxf.path.make_path(rocker).flattening(1e-4)])
    assert 0.5 * np.imag(np.conj(points) * np.roll(points, -1)).sum() == pytest.approx(area, rel=1e-4)
