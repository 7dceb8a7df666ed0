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


@pytest.mark.parametrize(("size", "step"), [(1.0, 40), (1000.0, 90)])
def test_the_centre_of_crank_and_rocker_lies_on_the_ground_line(tmp_path, size, step):
    """By Kennedy's theorem: its height is 0 to the last digit that is written."""
    sizes = {name: value * size for name, value in (("ground", 100), ("crank", 30), ("coupler", 90), ("rocker", 70))}
    for position in range(10, 350, step):
        (tmp_path / "r.toml").write_text(TEXT.format(position, **sizes))
        gk.make(tmp_path / "r.toml", tmp_path / "out")
        centres = json.loads((tmp_path / "out/r/summary.json").read_text())["instant_centres_mm"]
        x, y = centres["crank and rocker"]
        assert y == 0
        # The two turn about it at rates in the ratio of its distances from their pivots.
        motion = gk.move(gk.FourBar(*sizes.values()), [position * 3.141592653589793 / 180])
        ratio = motion.bodies["rocker"].omega[0]
        assert x / (x - sizes["ground"]) == pytest.approx(ratio, rel=1e-6, abs=1e-6)


def test_what_is_rounding_is_told_as_nothing(tmp_path):
    """A six-bar by its last link: centres at pivots on the axes are there exactly."""
    (tmp_path / "r.toml").write_text("""kind = "polygons"
position = -17
[linkage]
driver = "out"
estimate = { A = [25.2, 16.3], B = [68.6, -62.6], P = [93.1, -3.4] }
[linkage.bodies]
ground = { O = [0, 0], C = [100, 0], E = [99, 100] }
crank = { O = [0, 0], A = [30, 0] }
coupler = { A = [0, 0], B = [90, 0], P = [50, 50] }
rocker = { C = [0, 0], B = [70, 0] }
rod = { P = [0, 0], F = [120, 0] }
out = { E = [0, 0], F = [90, 0] }
[files]
write = ["csv"]
""")
    gk.make(tmp_path / "r.toml", tmp_path / "out")
    centres = json.loads((tmp_path / "out/r/summary.json").read_text())["instant_centres_mm"]
    places = [value for told in centres.values() if isinstance(told, list) for value in told]
    assert len(places) == 30 and [value for value in places if 0 < abs(value) < 1e-6] == []
