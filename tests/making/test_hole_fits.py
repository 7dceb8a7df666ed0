"""The fits that a part states for its holes are cut: widths, flats, keyways and travels measured on the outline."""

from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from tests.campaign import by_default
from tests.making.test_bases import PAIR, PLANETARY, RACK, cam

RECIPES = Path(__file__).parents[2] / "recipes"
GALLERY = [
    "lantern", "motor-crank", "motor-gear", "rack-and-pinion", "ring-gear", "straight-sided-ring", "rocker-cam", "flat-cam",
    "shaking-force", "scotch-yoke", "oldham-coupling",
]  # fmt: skip
MADE = {name: lambda name=name: gk.load(RECIPES / f"{name}.toml") for name in GALLERY}
MOTOR = 'motor = "nema17", bore = 5, bore_form = "D"'
CONJUGATE = 'kind = "straight-sided-gears"\ngear = {{teeth = 12, module = 4, dedendum = 1.1}}\nmate = {{teeth = 30, addendum = 3}}\nstock = {{{}}}\n'
LANTERN = 'kind = "lantern-gears"\npinion = {{pins = 12, module = 4, pin_diameter = 5}}\nmate = {{teeth = 48, addendum = 6}}\nstock = {{{}}}\n'
FORMS = {
    "pressed": 'bore = 10, fit = "press", interference = 0.2',
    "keyed": 'bore = 12, bore_form = "keyed", clearance = 0.3',
    "pressed on a flat": 'bore = 8, bore_form = "D", fit = "press", interference = 0.15',
    "own flat": 'bore = 9, bore_form = "D", flat = 7.25, clearance = 0.1',
    "own keyway": 'bore = 10, keyway_width = 2.5, keyway_depth = 1.25',
    "with a mate": 'bore = 10, mate_bore = 8, mate_bore_form = "D", clearance = 0.2',
    "pressed mate": 'bore = 10, mate_bore = 12, mate_bore_form = "keyed", mate_fit = "press"',
    "motor": f"{MOTOR}, thickness = 4",
}  # fmt: skip
SINGLE = 'kind = "spur-gear"\ngear = {{teeth = 30, module = 2}}\nstock = {{{}}}\n'
for form, stock in FORMS.items():
    for kind, text in (("pair", CONJUGATE), ("lantern", LANTERN)):
        MADE[f"{kind}, {form}"] = lambda text=text, stock=stock: gk.load(text.format(stock))
    if "mate" not in form:
        MADE[f"gear, {form}"] = lambda stock=stock: gk.load(SINGLE.format(stock))
for name, text in (("pair", PAIR), ("rack", RACK), ("planetary", PLANETARY)):
    for base in ("", "base = { clearance = 0.4 }\n"):
        MADE[f"{name}, {base}"] = lambda text=text, base=base: gk.load(base + text)
MADE |= {f"cam, {name}": lambda name=name: cam(name) for name in ("roller", "arm", "flat")}


def width(z, towards):
    return np.ptp(np.real(z * np.conj(towards)))


@pytest.mark.parametrize("name", by_default(list(MADE)[::3], slice(0, None, 2)))
def test_every_hole_is_as_wide_as_its_pin_and_clearance(name):
    seen, directions = 0, np.exp(1j * np.radians(np.arange(0, 180, 1.0)))
    for part in MADE[name]().parts:
        for hole, fit in zip(part.holes, part.fits):
            if fit is None:
                assert part.name == "ring" and not isinstance(hole, gk.plane.Circle)
                continue
            z, across, seen = gk.flatten(hole, 1e-4), fit.diameter + fit.play, seen + 1
            widths = np.array([width(z, towards) for towards in directions])
            if fit.travel:
                assert (widths.min(), widths.max()) == pytest.approx((across, across + fit.travel), abs=2e-3)
            elif fit.flat:
                assert (widths.min(), widths.max()) == pytest.approx((fit.flat, across), abs=2e-3)
            elif fit.keyway[0]:
                wide, deep = fit.keyway
                # About the part's axis: from the bore to the corners of the keyway.
                corner = np.hypot(across / 2 + deep, wide / 2)
                assert (np.abs(z).min(), np.abs(z).max()) == pytest.approx((across / 2, corner), abs=1e-3)
                assert np.abs(np.diff(z[np.abs(z) > corner - 1e-6])).max() == pytest.approx(wide, abs=1e-6)
            else:
                assert (widths.min(), widths.max()) == pytest.approx((across, across), abs=2e-3)
        # Round holes without a fit would be drawn without a note.
        untold = [hole for hole in part.holes[len(part.fits) :] if isinstance(hole, gk.plane.Circle)]
        assert not untold, part.name
    assert seen or name in ("ring-gear", "straight-sided-ring")
