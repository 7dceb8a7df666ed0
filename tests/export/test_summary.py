"""Sizes that summary.json states, against the files beside it."""

import json
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
import shapely
import trimesh

import geomkin as gk
from geomkin.build import _data
from geomkin.export.job import Job, StaticSource
from geomkin.export.summary import summary
from geomkin.recipe.kinds import kind_names
from geomkin.recipe.load import from_table
from tests.campaign import by_default
from tests.texts import recipe_of

RECIPE = """
kind = "four-bar"
linkage = { ground = 100, crank = 30, coupler = 90, rocker = 70 }
stock = { fastener = "rod" }
files = { labels = false, kerf = 0.4, tolerance = 0.1, curves = "%s" }
"""


@pytest.mark.campaign
@pytest.mark.parametrize("curves", ["chords", "arcs"])
def test_summary_has_written_and_exact_sizes(tmp_path, curves):
    """At this tolerance chords lose 0.5 % of the area, which a reader of the files must be able to see."""
    (tmp_path / "bars.toml").write_text(RECIPE % curves)
    gk.make(tmp_path / "bars.toml", tmp_path)
    parts = json.loads((tmp_path / "bars" / "summary.json").read_text())["parts"]
    rings = {"CUT": [], "HOLE": []}
    for entity in ezdxf.readfile(tmp_path / "bars" / "bars.dxf").modelspace():
        if entity.dxftype() == "CIRCLE":
            points = entity.flattening(1e-7)
        else:
            edges = list(entity.virtual_entities())
            points = [p for e in edges for p in (e.flattening(1e-7) if e.dxftype() == "ARC" else [e.dxf.start])]
        rings[entity.dxf.layer].append(shapely.Polygon([(p.x, p.y) for p in points]))
    cut = [ring.area - sum(h.area for h in rings["HOLE"] if ring.contains(h)) for ring in rings["CUT"]]
    assert sorted(p["written_area_mm2"] for p in parts) == pytest.approx(sorted(cut), rel=1e-6)
    for part in parts:
        mesh = trimesh.load(tmp_path / "bars" / f"{part['name']}.stl")
        assert part["written_volume_mm3"] == pytest.approx(mesh.volume, rel=1e-6)
        assert abs(part["written_volume_mm3"] / part["volume_mm3"] - 1) > 1e-4
        # The path lies half a kerf off the part on every side.
        around = 2 * np.pi * 7 + 2 * np.pi * 2.1 * 2
        assert part["written_area_mm2"] - part["area_mm2"] > 0.2 * around


def test_sizes_of_relieved_parts_are_those_of_the_drawing(tmp_path):
    gear = {"gear": {"teeth": 8, "module": 4}, "stock": {"bore": 10, "bore_form": "keyed"}}
    files = {"write": ["dxf", "stl"], "cutter": 2.0, "labels": False, "tolerance": 0.05}
    gk.make(gk.load({"kind": "spur-gear", "files": files, **gear}).with_name("hub"), tmp_path)
    (part,) = json.loads((tmp_path / "hub/summary.json").read_text())["parts"]
    lines = [line.vertices_in_wcs() for line in ezdxf.readfile(tmp_path / "hub/hub.dxf").modelspace()]
    hole, outline = sorted(shapely.Polygon([(p.x, p.y) for p in line]).area for line in lines)
    assert part["written_area_mm2"] == pytest.approx(outline - hole, rel=1e-9)
    assert part["area_mm2"] - part["written_area_mm2"] > 0.5 and "written_volume_mm3" in part


def test_parts_are_reported_with_exact_and_written_sizes():
    disc = gk.Part("scheibe ä", gk.plane.Circle(5j, 10.0), (gk.plane.Circle(5j, 2.0),), 2.5, count=3)
    bar = gk.Part("bar", gk.plane.Polyline(np.array([0, 20, 20 + 6j, 6j])), (), 4.0)
    job = Job("two", StaticSource((disc, bar), walls={"scheibe ä": 8.0}), 0.01, kerf=0.2)
    content = summary(job, {}, [], {"note": 1}, {}, ["b.txt"])
    # Nothing that JSON does not know, and letters as they are.
    data = json.loads(content, parse_constant=pytest.fail)
    assert "scheibe ä" in content.decode() and data["files"] == ["b.txt"] and data["note"] == 1
    one, two = data["parts"]
    assert (one["area_mm2"], one["volume_mm3"]) == pytest.approx((96 * np.pi, 240 * np.pi))
    assert (two["area_mm2"], two["volume_mm3"], two["count"], two["thickness_mm"]) == (120, 480, 1, 4)
    assert (one["thinnest_wall_mm"], two["thinnest_wall_mm"]) == (8, None)
    assert list(data["versions"]) == ["geomkin"] and "sheets" not in data
    for written, more in ((["svg"], "area"), (["stl"], "volume"), (["3mf", "dxf"], "both"), (["csv"], "")):
        data = json.loads(summary(job, {}, [], {}, {ending: [f"a.{ending}"] for ending in written}))
        (one, two), flat = data["parts"], more in ("area", "both")
        assert ("sheets" in data) == ("written_area_mm2" in one) == ("written_area_mm2" in two) == flat
        assert ("written_volume_mm3" in one) == ("written_volume_mm3" in two) == (more in ("volume", "both"))
        if flat:
            grown = (np.pi * (10.1**2 - 1.9**2), 20 * 6 + 0.2 * 26 + np.pi * 0.01)
            assert (one["written_area_mm2"], two["written_area_mm2"]) == pytest.approx(grown, abs=0.1)
        if "written_volume_mm3" in two:
            assert two["written_volume_mm3"] == pytest.approx(480)
        hands = {"numpy", "geomkin"} | ({"shapely"} if more else set()) | ({"ezdxf"} if more == "both" else set())
        assert set(data["versions"]) == hands and all(data["versions"].values())


@pytest.mark.parametrize("kind", by_default(kind_names(), ["four-bar", "machine", "disk-cam", "path-generator"]))
def test_a_summary_leaves_out_what_is_off_by_default_and_still_has_the_whole_recipe(kind):
    recipe = recipe_of(kind)
    data = _data(recipe)
    assert from_table(data) == recipe
    # So a new key, off by default, changes no summary and no stamp of a recipe without it.
    assert not [key for key, value in data.items() if value is None or value is False]
    if kind == "four-bar":
        assert _data(replace(recipe, both_modes=True)) == data | {"both_modes": True}
