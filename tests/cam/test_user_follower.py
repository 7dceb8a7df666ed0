"""A follower from outside: one class by the public contract and one row, and it goes from recipe text to DXF."""

from dataclasses import dataclass
from typing import Literal

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.laws import highest
from geomkin.core.fields import check_sizes, quantity


@dataclass(frozen=True)
class PointedBar(gk.cam.AbstractFollower):
    """A bar that slides on a line through the cam's axis, along +x, and touches with a sharp point.

    So the cam's radius is base radius and lift, in the direction that the bar comes from.
    """

    width: float = quantity("width of the bar", "mm", above=0, at_most=1000, example=8)
    kind: Literal["pointed-bar"] = "pointed-bar"
    oscillates = False
    roller_radius = 0.0

    def __post_init__(self):
        check_sizes(self)

    @property
    def size(self):
        return self.width

    @property
    def knife_edge(self):
        return self

    def check(self, program, base_radius, sense):
        if self.width > 2 * base_radius:
            raise gk.DesignError("follower.width", "it is wider than the cam", "give a narrower bar")

    def base_radius_range(self, largest_lift):
        return 0.0, np.inf

    def contact(self, motion, base_radius, sense):
        point = base_radius + motion.lift + 0j
        # By the library's own words: u is the point's velocity on the cam, the normal lies to one side of it.
        u = motion.velocity - 1j * sense * point
        normal = 1j * sense * u / np.abs(u)
        turn = (np.conj(u) * (motion.acceleration - 2j * sense * motion.velocity - point)).imag / np.abs(u) ** 2
        return gk.cam.Contact(point, normal, turn, np.abs(u), sense * np.angle(normal))

    def pose(self, lift, base_radius):
        """Origin at the point, x axis along the bar."""
        return gk.plane.Pose(base_radius + lift + 0j, np.ones(np.shape(lift), complex))

    def resting_lift(self, points, base_radius):
        # No width at all: only what lies on the line stops it.
        on_line = np.abs(points.imag) < 1e-9
        return np.where(on_line, points.real - base_radius, -np.inf)

    def surface_between(self, pose, start, end):
        return gk.plane.Segment(start, end)

    def outer_radius_bound(self, motion, base_radius, sense):
        return base_radius + motion.lift

    def convex_radius(self, program, base_radius, sense):
        def curvature(angle):
            contact = self.contact(program.motion(angle), base_radius, sense)
            return -sense * contact.normal_rate / contact.profile_speed

        bend, at = highest(program.breaks, curvature)
        return np.where(bend > 0, 1 / np.abs(bend), np.inf), at

    def undercut_violation(self, motion, base_radius, sense, least_radius):
        return np.full(np.shape(motion.lift), -1.0)

    def contact_travel(self, program, base_radius, sense):
        return None

    def plates(self, bars, program, base_radius, sense):
        half, end = self.width / 2, bars.stem_length
        corners = np.array(
            [0, complex(half, -half), complex(end + half, -half), complex(end + half, half), half * (1 + 1j)]
        )
        hole = gk.cam.Hole("pivot_bore", bars.pivot_bore, self.width, complex(end))
        return (gk.cam.FollowerPlate("pointed bar", gk.plane.Polyline(corners), (hole,)),)


@pytest.fixture
def row(monkeypatch):
    monkeypatch.setitem(gk.cam.FOLLOWERS, "pointed-bar", PointedBar)


RECIPE = """
kind = "disk-cam"

[cam]
base_radius = 30

[cam.follower]
kind = "pointed-bar"
width = 9

[[cam.program]]
kind = "rise"
law = "cycloidal"
rise = 12
end_deg = 150

[[cam.program]]
kind = "return"
law = "3-4-5"
end_deg = 360

[stock]
pivot_bore = 4

[files]
write = ["dxf", "csv"]
tolerance = 0.002
"""


def test_it_goes_from_recipe_text_to_a_file_to_cut(row, tmp_path):
    (tmp_path / "toy.toml").write_text(RECIPE)
    recipe = gk.load(tmp_path / "toy.toml")
    assert recipe.design.follower == PointedBar(9)
    assert [part.name for part in recipe.parts] == ["cam", "pointed bar"]
    gk.make(recipe, tmp_path)
    drawn = ezdxf.readfile(tmp_path / "toy" / "toy.dxf").modelspace()
    cuts = [np.array([p[:2] for p in line.get_points()]) for line in drawn.query("LWPOLYLINE[layer=='CUT']")]
    bar, plate = sorted(cuts, key=len)
    assert len(bar) == 5 and np.ptp(bar, axis=0) == pytest.approx([40 + 9 / 2, 9])
    # The known profile: radius 30 and the lift, so 60 and the lift at 180 deg from the highest place across.
    (shaft,) = [c for c in drawn.query("CIRCLE") if c.dxf.radius == 4]
    radius = np.hypot(*(plate - [shaft.dxf.center.x, shaft.dxf.center.y]).T)
    assert [radius.min(), radius.max()] == pytest.approx([30, 42], abs=0.002)
    assert 2 in [c.dxf.radius for c in drawn.query("CIRCLE")]


def test_its_cam_is_measured_and_judged_as_any_other(row):
    recipe = gk.load(RECIPE)
    cam, angles = recipe.design, np.linspace(0, 2 * np.pi, 50)
    lift = cam.program.motion(angles).lift
    assert np.abs(cam.profile.point(angles) - (30 + lift) * np.exp(-1j * angles)).max() < 1e-12
    assert np.abs(cam.pitch_curve.point(angles) - cam.profile.point(angles)).max() == 0
    velocity = cam.program.motion(angles).velocity
    assert gk.pressure_angle(cam, angles) == pytest.approx(np.arctan2(velocity, 30 + lift))
    assert not gk.undercut(cam).found and recipe.checks[0].name == "pressure angle on the rise"
    # Sharpest where both motions come to rest, on the base circle.
    assert gk.cam.segment_limits(cam).convex_radius == pytest.approx([30, 30])
    least = gk.cam.least_base_circle(PointedBar(9), cam.program, pressure_angle_deg=20)
    steepest = np.abs(gk.cam.cam_table(gk.Cam(PointedBar(9), cam.program, least.radius), 1.0, angles).columns[6].values)
    assert steepest.max() <= 20 < 1.02 * steepest.max()
    assert least.limit == "pressure angle"


def test_incomplete_follower_class_is_refused():
    members = {
        name: vars(PointedBar)[name] for name in gk.cam.AbstractFollower.__abstractmethods__ if name in vars(PointedBar)
    }
    for left_out in members:
        rest = {name: member for name, member in members.items() if name != left_out}
        with pytest.raises(TypeError):
            gk.cam.FOLLOWERS["forgetful"] = type("Forgetful", (gk.cam.AbstractFollower,), rest)
    assert "forgetful" not in gk.cam.FOLLOWERS
