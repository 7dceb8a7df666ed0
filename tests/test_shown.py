"""What is on the page of parts and of a curve: scales, trails, columns and plots."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.studio import notebook


@pytest.mark.parametrize("sizes", [(8e4, 1.0), (8e3, 0.1), (3.0, 2.0), (1e-3, 0.5e-3), (500.0, 1.0, 40.0)])
def test_parts_of_whatever_sizes_are_shown_as_finely_as_the_smallest_asks_for_and_the_largest_bears(sizes):
    """A tolerance far below the largest one's size is refused: what is shown keeps above that."""
    parts = [gk.Part(f"p{k}", gk.plane.Circle(0j, size / 2), (), 1.0) for k, size in enumerate(sizes)]
    scene = notebook._job(parts).scene
    assert {body.name for body in scene.bodies} == {part.name for part in parts}
    # They lie apart: no two discs come nearer than they are wide.
    radii = {part.name: size / 2 for part, size in zip(parts, sizes)}
    for k, one in enumerate(scene.bodies):
        for other in scene.bodies[:k]:
            assert abs(one.origin[0] - other.origin[0]) > radii[one.name] + radii[other.name]


@pytest.mark.parametrize(
    "curve",
    [
        gk.plane.Circle(3 + 4j, 2.0),
        gk.plane.Segment(1j, 30 + 41j),
        gk.SpurGear(9, 2).outline,
        gk.plane.Polyline(np.array([0, 10, 10 + 10j]), None, False),
    ],
    ids=lambda curve: type(curve).__name__,
)
def test_a_curve_s_columns_are_those_of_the_point_that_runs_along_it(curve):
    job = notebook._job(curve)
    scene, columns = job.scene, job.scene.table.to_columns()
    t, place = columns["t"], columns["point_x_mm"] + 1j * columns["point_y_mm"]
    assert (t[0], t[-1], len(t)) == (curve.breaks[0], curve.breaks[-1], notebook.FRAMES)
    assert place == pytest.approx(curve.point(t)) and scene.cyclic == curve.closed
    assert (scene.time[0], scene.time[-1]) == (0, 5) and np.ptp(np.diff(scene.time)) < 1e-12 and scene.assembled.all()
    # Speeds by differences, where no corner is near.
    step = 1e-4
    off = np.abs(t[:, None] - curve.breaks).min(axis=1)
    smooth = off > 2 * step
    ahead, behind = curve.point(t[smooth] + step), curve.point(t[smooth] - step)
    assert columns["speed_mm"][smooth] == pytest.approx(np.abs(ahead - behind) / (2 * step), rel=1e-4)
    bend = columns["curvature_1_per_mm"]
    assert not np.isinf(bend).any()
    turned = np.angle((ahead - place[smooth]) / (place[smooth] - behind)) / np.abs(ahead - place[smooth])
    known = np.isfinite(bend[smooth])
    assert bend[smooth][known] == pytest.approx(turned[known], rel=1e-3, abs=1e-4)
    # The curve as it is, a point with its trail, and each plot of columns there are.
    ((drawn,), (mark,)) = scene.curves, scene.marks
    assert drawn.curve is curve and drawn.role == "construction" and mark.trail and mark.role == "traced"
    assert mark.place == pytest.approx(place) and mark.sort == "point"
    assert [plot.columns for plot in scene.plots] == [
        ("curvature",), ("point_x", "point_y"), ("speed",),
    ]  # fmt: skip
    assert job.name == type(curve).__name__ and not job.source.parts and not job.source.checks


@pytest.mark.parametrize("thing", [(), [], ("part", 3), [3, "part"], ("part", None), ("part", ("part",))])
def test_a_row_is_shown_where_all_of_it_are_parts(thing):
    part = gk.Part("a", gk.plane.Circle(0j, 2.0), (), 1.0)
    thing = type(thing)(part if one == "part" else one for one in thing)
    with pytest.raises(gk.DesignError, match="thing: found .*; give a recipe, its file or text"):
        gk.show(thing)
    assert gk.show([part, part]).name == "2 parts" and gk.show((part,)).name == "a"
