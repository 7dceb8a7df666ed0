"""Tables of a page read back: verdicts with what to do, parts with their sizes, sheets, notes of every form."""

from html.parser import HTMLParser

import numpy as np

import geomkin as gk
from geomkin.export.job import Job, StaticSource
from geomkin.model.part import Part
from geomkin.model.scene import SceneBody
from geomkin.page import sections
from geomkin.plane.curve import Moved
from geomkin.plane.vec import Pose
from tests.export.test_animated_marks import FRAMES, scene_of

ONE = np.ones(FRAMES, dtype=complex)


class Rows(HTMLParser):
    """The words of each cell of each row, pictures left out."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.kept = [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.kept = True

    def handle_endtag(self, tag):
        self.kept = self.kept and tag not in ("td", "th")

    def handle_data(self, data):
        if self.kept:
            self.rows[-1][-1] += data


def rows_of(reported):
    return Rows(reported).rows[1:]


def job_of(parts=(), scene=None, **more):
    scene = scene or scene_of(bodies=[SceneBody("a", tuple(parts), ONE, ONE)])
    own = {key: more.pop(key) for key in ("checks", "walls", "bought", "steps", "notes") if key in more}
    return Job("a", StaticSource(tuple(parts), scene.table, scene, **own), 0.01, **more)


PLATE = gk.plane.Polyline(500 - 70j + np.array([0, 40, 40 + 25j, 25j]))
HOLES = (gk.plane.Circle(510 - 60j, 2.0), gk.plane.Polyline(520 - 60j + np.array([0, 5, 5 + 4j, 4j])))


def test_parts_are_reported_with_their_sizes_wherever_they_lie():
    one = Part("one", PLATE, HOLES, 3.0, count=2)
    two = Part("two", Moved(gk.plane.rounded_hull([0, 1234j], 10.0), Pose(-7e3 + 2j)), (), 0.5)
    dot = Part("dot", gk.plane.Circle(0j, 0.1), (), 3.0)
    reported = sections.parts(job_of([one, two, dot], walls={"one": 1.25}))
    length, area = 130 + 4 * np.pi + 18, 1000 - 4 * np.pi - 20
    long, wide = 2 * 1234 + 20 * np.pi, 20 * 1234 + 100 * np.pi
    assert rows_of(reported) == [
        ["", "one", "2", "40 × 25", "3", f"{area:.4g}", f"{length:.4g}", "1.25"],
        ["", "two", "1", "20 × 1254", "0.5", f"{wide:,.0f}", f"{long:.4g}"],
        ["", "dot", "1", "0.2 × 0.2", "3", "0.03142", "0.6283"],
    ]
    assert "Thinnest wall" in reported and "Sheet" not in reported
    bare = sections.parts(job_of([one]))
    assert "Thinnest wall" not in bare and "more" not in bare
    assert sections.parts(job_of()) == ""
