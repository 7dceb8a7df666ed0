"""Places of instant centres in the summary: digits of the linkage's size, and nothing of rounding."""

import json

import pytest

import geomkin as gk

TEXT = """kind = "polygons"
position = {}
[linkage]
driver = "crank"
[linkage.bodies]
ground = {{ O = [0, 0], C = [{ground}, 0] }}
crank = {{ O = [0, 0], A = [{crank}, 0] }}
coupler = {{ A = [0, 0], B = [{coupler}, 0] }}
rocker = {{ C = [0, 0], B = [{rocker}, 0] }}
[files]
write = ["csv"]
"""


@pytest.mark.parametrize("size", [1.0, 0.03, 1000.0])
def test_the_centre_of_crank_and_rocker_lies_on_the_ground_line(tmp_path, size):
    """By Kennedy's theorem: its height is 0 to the last digit that is written."""
    sizes = {name: value * size for name, value in (("ground", 100), ("crank", 30), ("coupler", 90), ("rocker", 70))}
    for position in range(10, 350, 20):
        (tmp_path / "r.toml").write_text(TEXT.format(position, **sizes))
        gk.make(tmp_path / "r.toml", tmp_path / "out")
        centres = json.loads((tmp_path / "out/r/summary.json").read_text())["instant_centres_mm"]
        x, y = centres["crank and rocker"]
        assert y == 0
        # The two turn about it at rates in the ratio of its distances from their pivots.
        motion = gk.move(gk.FourBar(*sizes.values()), [position * 3.141592653589793 / 180])
        ratio = motion.bodies["rocker"].omega[0]
        assert x / (x - sizes["ground"]) == pytest.approx(ratio, rel=1e-6, abs=1e-6)
