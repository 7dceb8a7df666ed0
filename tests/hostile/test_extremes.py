"""Legal sizes at their ends: sound files, or one line that says what to change."""

import subprocess

import ezdxf
import pytest
from shapely.geometry import Polygon

DWELL = '{kind = "dwell", end_deg = 360}'
KNIFE = '{kind = "translating-roller", roller_radius = 0}'
# A rise and return across every 3.6 deg; the last ends the turn exactly.
WAVES = [
    f'{{kind = "rise", law = "3-4-5", rise = 0.1, end_deg = {3.6 * k + 1.8}}}, '
    f'{{kind = "return", law = "3-4-5", end_deg = {3.6 * k + 3.6 if k < 99 else 360}}}'
    for k in range(100)
]


ENDS = [
    ("four-bar", {"linkage.coupler_point": "[90.0, -0.0]"}),
    ("four-bar", {"linkage.coupler_point": "[165, 1e-6]"}),
    ("four-bar", {"linkage.ground_angle_deg": "1e308"}),
    ("four-bar", {"drive.speed_rpm": "1e300"}),
    ("four-bar", {"stock.thickness": "1e-6"}),
    ("disk-cam", {"cam.program": f"[{DWELL}]"}),
    ("disk-cam", {"cam.follower": KNIFE.replace("0}", "10, offset = -49.999}")}),
    ("disk-cam", {"drive.speed_rpm": "1e-150"}),
    ("spur-gear", {"gear.teeth": "5", "stock.bore": "0"}),
    ("spur-gear", {"gear.rack.tip_radius": "0", "files.kerf": "0.2"}),
    ("spur-gear", {"stock.bore": "42.99999"}),
    ("ring-gear", {"gear.tooth_thickness_allowance": "1e-300"}),
    ("ring-gear", {"gear.module": "1e-12"}),
    ("ring-gear", {"stock.rim": "0.1", "files.kerf": "0.5"}),
]
# Every other one in one of the two by turns, the rest in campaigns.
DRAWN = [
    pytest.param(
        *end, curves, id=f"{end} {curves}", marks=() if k % 2 == 0 and k // 2 % 2 == side else pytest.mark.campaign
    )
    for k, end in enumerate(ENDS)
    for side, curves in enumerate(("chords", "arcs"))
]


@pytest.mark.parametrize(("kind", "changes", "curves"), DRAWN)
def test_an_extreme_is_made_sound_or_refused_with_a_remedy(run, refused, sound, recipe, kind, changes, curves):
    result = run(recipe(kind, changes | {"files.curves": f'"{curves}"'}))
    if result.exit_code:
        refused(result, many=True)
    else:
        assert "summary.json" in sound("out/r")


@pytest.mark.parametrize("unit", ["1e-9", "1e5"])
def test_motion_keeps_its_digits_at_any_size(run, sound, recipe, here, unit):
    lengths = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "coupler_point": [40, 25]}
    stock = {"bar_width": 14, "pin_diameter": 4, "clearance": 0.2}
    scaled = {"files.write": '["csv"]'}
    for table, sizes in (("linkage", lengths), ("stock", stock)):
        for key, value in sizes.items():
            size = [v * float(unit) for v in value] if isinstance(value, list) else value * float(unit)
            scaled[f"{table}.{key}"] = str(size)
    assert run(recipe("four-bar", scaled)).exit_code == 0
    assert run(recipe("four-bar", {"files.write": '["csv"]'}), "--out", "plain").exit_code == 0
    assert sound("out/r")
    rows = [[line.split(",") for line in (here / out / "r/r.csv").read_text().split()] for out in ("out", "plain")]
    column = rows[0][0].index("transmission_angle_deg")
    assert len(rows[0]) == 74
    for mine, plain in zip(rows[0][1:], rows[1][1:], strict=True):
        assert float(mine[column]) == pytest.approx(float(plain[column]), rel=1e-9)


@pytest.mark.parametrize(("module", "bore", "kerf"), [("2", "8", "0.2"), ("2", "8", "4"), ("0.3", "1", "0.5")])
def test_the_part_that_falls_out_of_the_cut_is_the_part_asked_for(run, recipe, here, module, bore, kerf):
    """A beam too wide for the tooth spaces leaves metal in them; that must not pass in silence."""
    gear = {"gear.module": module, "stock.bore": bore, "files.write": '["dxf"]'}
    assert run(recipe("spur-gear", gear)).exit_code == 0
    result = run(recipe("spur-gear", gear | {"files.kerf": kerf}), "--out", "kerf")
    if "kerf" in result.stderr:
        return  # refused, or reported as a failed check
    areas = []
    for out, cut in (("out", 0.0), ("kerf", float(kerf))):
        entities = ezdxf.readfile(here / out / "r/r.dxf").modelspace()
        outline = next(e for e in entities if e.dxf.layer == "CUT")
        areas.append(Polygon(outline.get_points("xy")).buffer(-cut / 2, quad_segs=64).area)
    assert areas[1] == pytest.approx(areas[0], rel=2e-3)


@pytest.mark.parametrize(
    ("kind", "changes"),
    [
        pytest.param(
            "spur-gear",
            {"gear.teeth": "10_000", "gear.module": "0.5", "files.write": '["svg", "csv"]'},
            marks=pytest.mark.campaign,
        ),
        ("spur-gear", {"gear.module": "1e12", "files.write": '["csv"]'}),
        pytest.param(
            "disk-cam",
            {"cam.base_radius": "400", "cam.program": f"[{', '.join(WAVES)}]"},
            marks=pytest.mark.campaign,
        ),
    ],
    ids=["10000 teeth", "table of a giant", "200 segments"],
)
def test_large_recipes_are_made_or_refused_in_30_seconds(command, here, recipe, kind, changes):
    (here / "r.toml").write_text(recipe(kind, changes))
    try:
        done = command("run", "r.toml", timeout=30)
    except subprocess.TimeoutExpired:
        pytest.fail("nothing after 30 s")
    assert done.returncode == 0 or (done.returncode == 1 and done.stderr.startswith("r.toml: ")), done.stderr
