"""Editing as a pure function: text in, text and scene out; drags that follow the pointer as far as the recipe allows."""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.page.page import scene_data
from geomkin.recipe.kinds import kind_names, recipe_class
from geomkin.recipe.template import template
from geomkin.studio.drafts import Draft
from geomkin.studio.edit import answer
from geomkin.studio.form import recipe_form
from tests.campaign import by_default

FOUR_BAR = """# A comment at the top.
kind = "four-bar"

[linkage]  # lengths in mm
ground = 100
crank = 30.00  # driven
coupler = 90
rocker = 70
coupler_point = [40, 25]  # the pen
"""
SLIDER = 'kind = "slider-crank"\n[linkage]\ncrank = 30\ncoupler = 100\noffset = 15\n'


def handle_at(reply, id, frame):
    handle = next(handle for handle in reply["handles"] if handle["id"] == id)
    return np.array([row[frame] if isinstance(row, list) else row for row in handle["at"]])


def dragged(text, id, by, frame=40, **more):
    """The reply to a drag of a handle by so many mm, and where it was to go."""
    to = handle_at(answer(text, {}, {}), id, frame) + by
    drag = {"handle": id, "to": to.tolist(), "frame": frame, "step": 0.25, **more.pop("drag", {})}
    return answer(text, {}, {"drag": drag, **more}), to


def test_the_scene_is_that_of_the_page():
    reply = answer(FOUR_BAR, {}, {}, "pen")
    assert reply["scene"] == scene_data(gk.load(FOUR_BAR).scene, "pen") and not reply["problems"]
    assert json.loads(json.dumps(reply, allow_nan=False)) == reply


@pytest.mark.campaign
@pytest.mark.parametrize(("text", "by"), [(FOUR_BAR, (3, 4)), (SLIDER, (-0.7, 2))])
def test_a_dragged_point_read_back_is_under_the_pointer(text, by):
    for id in [handle["id"] for handle in answer(text, {}, {})["handles"]]:
        reply, to = dragged(text, id, by)
        at = handle_at(answer(reply["text"], {}, {}), id, 40)
        keys = next(handle["keys"] for handle in reply["handles"] if handle["id"] == id)
        two = len(keys) > 1 or keys[0] in ("linkage.coupler_point", "linkage.origin")
        before = to - by
        # With one length the point can only approach the pointer.
        assert np.linalg.norm(at - to) < (0.25 if two else np.linalg.norm(by)), id
        assert not np.allclose(at, before) and reply["limit"] is None


def test_a_drag_changes_only_unlocked_keys_of_its_handle():
    reply, _ = dragged(FOUR_BAR, "point:rocker_pin", (3, 4), locks=["linkage.coupler"])
    before, after = (tomllib.loads(text)["linkage"] for text in (FOUR_BAR, reply["text"]))
    assert {key for key in after if after[key] != before[key]} == {"rocker"}
    reply, _ = dragged(FOUR_BAR, "point:rocker_pin", (3, 4), locks=["linkage"])
    assert reply["text"] == FOUR_BAR and reply["limit"]["keys"] == ["linkage.coupler", "linkage.rocker"]
    assert all(handle["locked"] for handle in reply["handles"])


def test_a_drag_stops_where_the_linkage_could_no_longer_turn():
    x, y = handle_at(answer(FOUR_BAR, {}, {}), "point:crank_pin", 40) / 30
    # Grashof: crank + ground <= coupler + rocker, so 60 mm is the most for a full turn.
    reply, _ = dragged(FOUR_BAR, "point:crank_pin", (35 * x, 35 * y))
    crank = tomllib.loads(reply["text"])["linkage"]["crank"]
    assert 59 < crank <= 60 and reply["limit"]["reason"] and not reply["problems"]
    assert gk.load(reply["text"]).motion.assembled.all()
    # Further on it crosses the change point, and no link turns fully.
    reply, _ = dragged(FOUR_BAR, "point:crank_pin", (40 * x, 40 * y))
    crank, motion = tomllib.loads(reply["text"])["linkage"]["crank"], gk.load(reply["text"]).motion
    assert crank == pytest.approx(70, abs=0.3) and not reply["problems"] and reply["limit"] is None
    assert motion.assembled[40] and not motion.assembled.all()


@pytest.mark.parametrize("step", [0.25, 0.004, 3.0])
def test_a_drag_writes_as_many_digits_as_a_pixel_resolves(step):
    reply, to = dragged(FOUR_BAR, "point:coupler_point", (3.14159, 2.71828), drag={"step": step})
    assert np.linalg.norm(handle_at(reply, "point:coupler_point", 40) - to) < step
    written = reply["text"].split("coupler_point = [")[1].split("]")[0].split(", ")
    digits = max(len(number.partition(".")[2]) for number in written)
    assert digits <= max(0, np.ceil(-np.log10(step / 4)))


def test_a_snapped_drag_gives_round_values():
    reply, _ = dragged(FOUR_BAR, "point:coupler_point", (3.3, 2.2), drag={"snap": True})
    x, y = tomllib.loads(reply["text"])["linkage"]["coupler_point"]
    assert x % 1 == y % 1 == 0 and (x, y) != (40, 25)


def test_comments_order_and_typed_numbers_stay():
    reply = answer(FOUR_BAR, {}, {"set": {"linkage.coupler": 91.5, "drive.speed_rpm": 90}})
    lines = FOUR_BAR.replace("coupler = 90", "coupler = 91.5").splitlines()
    assert reply["text"].splitlines()[: len(lines)] == lines
    assert tomllib.loads(reply["text"])["drive"] == {"speed_rpm": 90}
    assert (
        answer(reply["text"], {}, {"set": {"drive": None, "linkage.coupler": 90}})["text"].strip() == FOUR_BAR.strip()
    )


def test_a_drag_of_a_scaled_recipe_writes_sizes_before_scaling():
    text = FOUR_BAR.replace('kind = "four-bar"', 'kind = "four-bar"\nscale = 0.5')
    reply, to = dragged(text, "point:coupler_point", (2, 1))
    assert np.linalg.norm(handle_at(reply, "point:coupler_point", 40) - to) < 0.25
    x, y = tomllib.loads(reply["text"])["linkage"]["coupler_point"]
    assert abs(np.hypot(x - 40, y - 25) - 2 * np.hypot(2, 1)) < 0.5


def test_a_point_that_is_left_out_is_written_whole():
    text = 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n'
    reply, _ = dragged(text, "origin:ground", (0, 5))
    assert tomllib.loads(reply["text"])["linkage"]["origin"] == [0, 5]


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"linkage.crank": -3}, "linkage.crank"),
        ({"linkage.crank": "wide"}, "linkage.crank"),
        ({"linkage.crank": None}, "linkage.crank"),
        ({"linkage.no_such": 1}, "linkage.no_such"),
        ({"linkage.crank.deep": 1}, "linkage.crank.deep"),
        ({"linkage.coupler_point[7]": 1}, "linkage.coupler_point[7]"),
        ({"kind": "six-pack"}, "kind"),
    ],
)
def test_a_wrong_value_is_reported_at_its_key(change, key):
    reply = answer(FOUR_BAR, {}, {"set": change})
    assert [problem["key"] for problem in reply["problems"]] == [key] and reply["scene"] is None
    assert "# A comment at the top." in reply["text"]


def test_a_text_that_is_not_toml_is_kept():
    for text in ("", "kind = ", "[[", "\0", "x" * 5000, '"' * 99):
        for request in ({}, {"set": {"linkage.crank": 3}}, {"drag": {"handle": "point:A", "to": [0, 0], "frame": 0}}):
            reply = answer(text, {}, request)
            assert reply["problems"] and (text in reply["text"] or not text)


@pytest.mark.parametrize("wrong", ["nonsense", "offset = ", "offset = yes", "crank = 3", "[linkage]", '"'])
def test_a_change_of_a_text_that_is_not_toml_states_the_same_problem_as_the_text(wrong):
    text = FOUR_BAR + wrong
    (problem,) = answer(text, {}, {})["problems"]
    for request in ({"set": {"linkage.crank": 33}}, {"set": {"linkage.crank": None}}, {"add": "loads"}):
        reply = answer(text, {}, request)
        assert reply["problems"] == [problem] and reply["text"] == text


def test_an_item_of_a_list_that_is_left_out_is_written_with_the_whole_list():
    text = 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n'
    reply = answer(text, {}, {"set": {"linkage.origin[1]": 5, "files.write[0]": "svg"}})
    table = tomllib.loads(reply["text"])
    assert not reply["problems"] and table["linkage"]["origin"] == [0, 5]
    assert table["files"]["write"] == ["svg", *gk.load(text).files.write[1:]]


def test_a_row_of_tables_is_not_replaced_by_a_number():
    text = f"{FOUR_BAR}[[copies]]\nphase_deg = 180\n"
    reply = answer(text, {}, {"set": {"copies[0]": 3}})
    assert reply["text"] == text and [problem["key"] for problem in reply["problems"]] == ["copies[0]"]


def test_rows_can_be_added_and_removed():
    text = answer(FOUR_BAR, {}, {"set": {"copies[0]": {"phase_deg": 180}}})["text"]
    assert tomllib.loads(text)["copies"] == [{"phase_deg": 180}]
    assert "copies" not in tomllib.loads(answer(text, {}, {"set": {"copies": None}})["text"])


def test_checks_and_parts_come_in_their_own_lane():
    recipe, reply = gk.load(FOUR_BAR), answer(FOUR_BAR, {}, {"lane": "checks"})
    assert [check["id"] for check in reply["checks"]] == [check.id for check in recipe.checks]
    assert [part["name"] for part in reply["parts"]["parts"]] == [part.name for part in recipe.parts]
    assert reply["scene"] is None and not reply["problems"]


PURE = """
import sys
from pathlib import Path
from geomkin.studio.edit import answer
text, files = Path("recipes/table-cam.toml").read_text(), {"table-cam-lift.csv": Path("recipes/table-cam-lift.csv").read_text()}
bar = Path("recipes/crank-rocker.toml").read_text()
drag = {"drag": {"handle": "point:crank_pin", "to": [31, 7], "frame": 3}}
def work():
    return answer(text, files, {"set": {"files.kerf": 0.1}, "lane": "checks"}), answer(bar, {}, drag)
before = work()
events = []
sys.addaudithook(lambda name, args: events.append(name))
assert work() == before
print(*sorted(set(events)))
"""


def test_it_opens_no_file_socket_or_thread():
    run = subprocess.run([sys.executable, "-c", PURE], capture_output=True, text=True, check=True)
    forbidden = ("open", "os.", "socket.", "_thread", "subprocess", "import", "shutil", "tempfile")
    assert not [event for event in run.stdout.split() if event.startswith(forbidden)]


@pytest.mark.parametrize("kind", by_default(kind_names(), slice(0, None, 3)))
def test_the_form_of_a_kind_has_every_key_that_a_recipe_can_have(kind):
    values = Draft(template(recipe_class(kind)), {}).values
    known = keys_of(recipe_form(kind, values)["groups"]) | {"kind"}
    tables = tuple(f"{key[:-2]}." for key in known if key.endswith(".*"))
    for key in values:
        key = re.sub(r"\[\d+\]", "[]", key)
        # A recipe inside another does not use its files, and its kind is the title of its group.
        inner = re.search(r"\.recipe\.(kind|optimise|files\b.*)$", key)
        assert key in known or f"{key}[]" in known or key.startswith(tables) or inner, key


def keys_of(groups):
    """Keys of all fields and tables of a form; those of tables whose keys a recipe chooses also end with `.*`."""
    json.dumps(groups, allow_nan=False)
    fields = [f for group in groups for some in (group["fields"], *group.get("kinds", {}).values()) for f in some]
    chosen = {f"{f['key']}.*" for f in fields if f["type"] == "table"}
    return {f["key"] for f in fields} | {group["key"] for group in groups} | chosen


@pytest.mark.campaign
def test_the_form_of_a_machine_has_the_fields_of_its_mechanisms():
    text, leg = (Path(f"recipes/{stem}.toml").read_text() for stem in ("geared-legs", "walker"))
    files = {"walker.toml": leg}
    groups = {group["key"]: group for group in recipe_form("machine", answer(text, files, {})["values"])["groups"]}
    fields = {field["key"]: field for group in groups.values() for field in group["fields"]}
    # Values of the machine's own text have the units and limits of their kind; those of a file are edited in it.
    assert (fields["mechanisms.right.phase_deg"]["unit"], fields["mechanisms.left.angle_deg"]["most"]) == ("deg", 360)
    train = {field["key"]: field for group in recipe_form("gear-train")["groups"] for field in group["fields"]}
    assert fields["mechanisms.train.recipe.train.module"] | {"key": "train.module"} == train["train.module"]
    assert "walker.toml" in groups["mechanisms.left"]["help"]
    assert not [key for key in fields if key.startswith("mechanisms.left.recipe.")]
    # Each of them can be set, and the text keeps its form.
    changes = {"mechanisms.right.phase_deg": 170, "mechanisms.train.recipe.train.module": 1.1}
    reply = answer(text, files, {"set": changes})
    changed = [line for line, old in zip(reply["text"].splitlines(), text.splitlines(), strict=True) if line != old]
    assert not reply["problems"] and len(changed) == 2
    assert {reply["values"][key] for key in changes} == {170, 1.1}
    assert "left" not in tomllib.loads(answer(text, files, {"set": {"mechanisms.left": None}})["text"])["mechanisms"]


def test_quantities_beside_the_scene():
    def quantities(stem):
        reply = answer(Path(f"recipes/{stem}.toml").read_text(), {}, {})
        return {row["label"]: row["text"] for row in reply["quantities"]}

    # The lengths of Jansen's leg.
    leg = quantities("walking-leg")
    assert (leg["crank"], leg["upper rod"], leg["triangle"]) == ("15 mm", "50 mm", "41.5, 55.8, 40.1 mm")
    # The extremes of the transmission angle are at the crank in line with the ground: law of cosines.
    bar = quantities("crank-rocker")
    angles = [np.degrees(np.arccos((90**2 + 70**2 - side**2) / (2 * 90 * 70))) for side in (70, 130)]
    least = min(min(angle, 180 - angle) for angle in angles)
    low, _, high, _ = bar["transmission angle"].split()
    assert float(low) == pytest.approx(least, abs=0.01) and 89 < float(high) <= 90
    assert bar["Grashof type"] == "crank-rocker"
    # By how much the crank turns while the output stands still.
    way, start, end = re.findall(r"[\d.]+", quantities("stephenson-dwell")["dwell of output"])
    assert float(way) == pytest.approx(float(end) - float(start), abs=0.2) and 100 < float(way) < 120
    # A worked example of gear handbooks.
    assert quantities("gear-pair")["centre distance"] == "56.4999 mm"
    assert quantities("undercut-cam")["undercut"] != "none" == quantities("roller-cam")["undercut"]


def test_checks_of_the_motion_are_quantities_and_those_of_the_plates_come_later():
    rows = {row["id"] for row in answer(FOUR_BAR, {}, {})["quantities"]} - {""}
    checks = {check["id"] for check in answer(FOUR_BAR, {}, {"lane": "checks"})["checks"]}
    walls = {f"wall_{part.name}" for part in gk.load(FOUR_BAR).parts}
    assert rows < checks and checks - rows == walls | {"collisions", "pin_hole"}


@pytest.mark.parametrize("stem", by_default(["five-poses", "wiper"], ["five-poses"]))
def test_the_picture_of_a_candidate_has_the_links_of_the_linkage_that_its_key_chooses(stem):
    text = Path(f"recipes/{stem}.toml").read_text()
    for candidate in answer(text, {}, {"lane": "checks"})["candidates"][:2]:
        chosen = gk.load(answer(text, {}, {"set": {candidate["key"]: candidate["value"]}})["text"]).design.linkage
        # The ground is a line that stays, and the links have a line for each frame, all of one length.
        (ground_x, ground_y), *links = candidate["lines"][:4]
        moving = [np.diff(x)[:, 0] + 1j * np.diff(y)[:, 0] for x, y in links]
        assert np.ptp(np.abs(moving), axis=1) == pytest.approx(0, abs=0.05)
        drawn = [abs(complex(*np.diff([ground_x, ground_y])[:, 0])), *np.abs(moving)[:, 0]]
        links = [getattr(chosen, name) for name in ("ground", "crank", "coupler", "rocker")]
        assert sorted(drawn) == pytest.approx(sorted(links), rel=1e-3)


def test_there_is_nothing_to_choose_in_a_recipe_without_a_search():
    assert answer(FOUR_BAR, {}, {"lane": "checks"})["candidates"] == []


def test_a_wrong_text_has_the_values_that_it_states():
    text = FOUR_BAR.replace("ground = 100", "ground = 1e300")
    reply = answer(text, {}, {})
    assert reply["problems"] and not reply["values"]
    assert reply["written"]["linkage.ground"] == 1e300 and reply["written"]["linkage.rocker"] == 70
    assert answer("kind", {}, {})["written"] == {} and answer(FOUR_BAR, {}, {})["written"] == {}


def test_a_drag_keeps_the_shafts():
    drag = {"handle": "point:rocker_pin", "to": [90, 60], "frame": 0, "step": 0.1}
    dragged = answer(FOUR_BAR, {}, {"drag": drag})
    assert dragged["shafts"] and dragged["shafts"] == answer(dragged["text"], {}, {})["shafts"]
