"""A kind of gear made outside, of the public contracts alone: its class, its recipe and a row in the table of kinds."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.core.fields import check_sizes, entry, quantity
from geomkin.gear import AbstractFlankGear, AbstractGear
from geomkin.gear.kinds.conjugate_gears import ToothedRecipe
from geomkin.recipe import AbstractRecipe, Files
from geomkin.recipe.kinds import KINDS, KindRow

TEXT = """
kind = "ratchet-wheel"

[gear]
teeth = 12
module = 4

[stock]
bore = 8
"""


@dataclass(frozen=True)
class RatchetWheel(AbstractGear):
    """A wheel with saw teeth, for a pawl."""

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=200, example=12)
    module: float = quantity("tip diameter per tooth", "mm", above=0, at_most=100, example=4)
    depth: float = quantity("depth of the teeth", "modules", default=0.8, above=0, at_most=1.5)
    land: float = quantity("width of the tips", "modules", default=0.3, above=0, at_most=1)

    def __post_init__(self):
        check_sizes(self)

    @property
    def tip_radius(self):
        return self.module * self.teeth / 2

    @property
    def pitch_radius(self):
        return self.tip_radius

    @property
    def root_radius(self):
        return self.tip_radius - self.module * self.depth

    @property
    def tip_thickness(self):
        return self.module * self.land

    @property
    def outline(self):
        half = self.tip_thickness / self.tip_radius / 2
        right, left = (self.tip_radius * 1j * np.exp(1j * a) for a in (-half, half))
        root = self.root_radius * 1j * np.exp(1j * half)
        corners = root * np.exp(-2j * np.pi / self.teeth), right, left, root
        return gk.plane.PolarArray(
            gk.plane.Path(tuple(gk.plane.Segment(a, b) for a, b in zip(corners, corners[1:]))), self.teeth
        )


@dataclass(frozen=True, kw_only=True)
class RatchetWheelRecipe(AbstractRecipe):
    """A ratchet wheel."""

    kind: Literal["ratchet-wheel"] = "ratchet-wheel"
    gear: RatchetWheel
    stock: gk.gear.GearStock = entry("what the wheel is cut from", default=gk.gear.GearStock())
    files: Files = entry("what is written", default=Files())

    @property
    def design(self):
        return self.gear

    @cached_property
    def table(self):
        step = np.arange(self.gear.teeth + 1)
        return gk.Table((gk.Column("turn", "deg", "where the pawl falls in", 360 * step / self.gear.teeth),))

    @property
    def design_checks(self):
        return gk.gear.gear_checks(self.design, self.stock.rim_under(self.design))

    @cached_property
    def parts(self):
        return gk.gear.gear_parts(self.design, self.stock, "wheel")


@pytest.fixture
def kind(monkeypatch):
    monkeypatch.setitem(KINDS, "ratchet-wheel", KindRow("toys", f"{__name__}:RatchetWheelRecipe"))


def test_a_gear_kind_from_outside_goes_from_a_text_to_a_drawing_and_checks(kind, tmp_path):
    (tmp_path / "ratchet.toml").write_text(TEXT)
    made = gk.make(tmp_path / "ratchet.toml", tmp_path / "out")
    drawing = ezdxf.readfile(tmp_path / "out" / "ratchet" / "ratchet.dxf").modelspace()
    (outline,) = drawing.query('LWPOLYLINE[layer=="CUT"]')
    assert len(outline) == 12 * 3 and outline.closed
    (hole,) = drawing.query("CIRCLE")
    assert hole.dxf.radius == 4
    assert {c.name for c in gk.load(TEXT).checks} >= {"tip thickness", "rim under the teeth"} and made


@pytest.mark.parametrize(
    ("stock", "field"), [(gk.gear.GearStock(bore=100), "stock.bore"), (gk.gear.RingStock(), "stock")]
)
def test_impossible_stock_is_refused(stock, field):
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.gear_parts(RatchetWheel(12, 4), stock)
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("gear", "stock", "name"),
    [
        (gk.SpurGear(24, 2), gk.gear.GearStock(bore=8), "gear"),
        (gk.RingGear(60, 2), gk.gear.RingStock(), "ring"),
        (gk.gear.GearRack(12, 2), gk.gear.GearStock(bore=8), "rack"),
        (gk.gear.StraightSidedGear(40, 3), gk.gear.GearStock(bore=8), "gear"),
        (gk.gear.FlankGear(gk.plane.Segment(3 + 33j, 1 + 38j), 24, 36.0), gk.gear.GearStock(bore=8), "gear"),
        (RatchetWheel(12, 4), gk.gear.GearStock(bore=8), "wheel"),
    ],
)
def test_every_gear_has_a_plate_and_checks(gear, stock, name):
    (part,) = gk.gear.gear_parts(gear, stock, name)
    assert part.name == name and gk.area(part.outline) > sum(gk.area(hole) for hole in part.holes)
    checks = gk.gear.gear_checks(gear)
    assert checks and all(np.isfinite(check.value) for check in checks)
    assert gk.gear.gear_checks(gear, stock.rim_under(gear), "a")[-1].name.startswith("a rim")


def test_a_rack_is_a_bar_whatever_is_cut_out_of_its_pinion():
    """Teeth 1.25 modules deep in a bar 2 modules high leave 0.75 modules under them."""
    rack, stock = gk.gear.GearRack(12, 2, height=2.0), gk.gear.GearStock(bore=8, web=gk.gear.Web(hub=20, rim=4))
    (bar,) = gk.gear.gear_parts(rack, stock)
    rim = gk.gear.gear_checks(rack, stock.rim_under(rack))[-1]
    assert bar.holes == () and rim.value == pytest.approx(0.75)
    assert rim == gk.gear.gear_checks(rack)[-1]


@dataclass(frozen=True)
class BluntGear(AbstractFlankGear):
    """A gear with radial flanks, given by one of them alone."""

    teeth: int = quantity("number of teeth", whole=True, at_least=8, at_most=200, example=40)
    module: float = quantity("pitch diameter per tooth", "mm", above=0, at_most=100, example=2)

    @property
    def pitch_radius(self):
        return self.module * self.teeth / 2

    @cached_property
    def flank(self):
        ray = 1j * np.exp(-0.5j * np.pi / self.teeth)
        return gk.plane.Segment(
            ray * (self.pitch_radius - 1.2 * self.module), ray * (self.pitch_radius + 0.05 * self.module)
        )


@dataclass(frozen=True, kw_only=True)
class BluntGearsRecipe(ToothedRecipe):
    """A gear with radial flanks and its mate."""

    kind: Literal["blunt-gears"] = "blunt-gears"
    gear: BluntGear


def test_a_tooth_form_from_outside_shapes_its_mate(monkeypatch):
    """Where radial flanks touch, the normal passes the pitch point: the flank's foot on a circle of half the size."""
    monkeypatch.setitem(KINDS, "blunt-gears", KindRow("toys", f"{__name__}:BluntGearsRecipe"))
    text = 'kind = "blunt-gears"\n[gear]\nteeth = 40\nmodule = 2\n[mate]\nteeth = 60\naddendum = 2\nclearance = 0.4\n'
    recipe = gk.load(text)
    assert [part.name for part in recipe.parts] == ["gear", "mate"] and all(np.isfinite(c.value) for c in recipe.checks)
    contact = recipe.design.contact(np.linspace(0, 1, 41))
    place = contact.place[np.isfinite(contact.angle)]
    assert len(place) > 5 and np.abs(place - 20j) == pytest.approx(20, rel=1e-9)
