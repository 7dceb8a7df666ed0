"""Linkages built by edits: text in, text out; the result moves as the same linkage computed apart."""

import tomllib

import numpy as np
import pytest

import geomkin as gk
from geomkin.studio.building import EMPTY, built
from geomkin.studio.clicks import EDITS
from geomkin.studio.drafts import Draft
from geomkin.studio.edit import answer
from tests.campaign import by_default

from ..browser.test_editor import RECIPES


def at(x, y, **names):
    return {"at": [x, y], **names}


def point(name):
    return at(0, 0, point=name)


def body(name):
    return at(0, 0, body=name)


def build(text, do, *on, **more):
    """The reply to an edit."""
    return answer(text, {}, {"build": {"do": do, "on": list(on), "frame": 0, "step": 0.4, **more}})


def built_by(*edits, text=EMPTY):
    """The text after several edits, each of which is possible."""
    for do, *on in edits:
        text = built(Draft(text, {}), {"do": do, "on": on, "step": 0.4})
    return text


FOUR_BAR = (
    ("pivot", at(0.1, -0.2)),
    ("pivot", at(80, 0)),
    ("bar", point("A"), at(10, 20)),
    ("dyad", point("C"), point("B"), at(70, 60)),
    ("trace", body("bar_1"), at(30, 70)),
)


def test_a_four_bar_built_by_clicks_moves_as_the_named_one():
    recipe = gk.load(built_by(*FOUR_BAR))
    turn = np.linspace(0, 2 * np.pi, 50)
    crank, coupler, rocker = (np.hypot(*arm) for arm in ((10, 20), (60, 40), (10, 60)))
    direction = complex(60, 40) / coupler
    pen = complex(20, 50) / direction
    apart = gk.move(gk.FourBar(80, crank, coupler, rocker, pen), turn + np.arctan2(20, 10))
    motion = gk.move(recipe.linkage.linkage, turn, recipe.made.branch)
    assert np.allclose(motion.point("E").position, apart.point("coupler_point").position)
    assert [*recipe.linkage.bodies] == ["ground", "crank", "bar_1", "bar_2"]


def test_degrees_of_freedom_are_stated_until_it_moves():
    text, freedoms = EMPTY, []
    for do, *on in (
        ("pivot", at(0, 0)),
        ("plate", at(40, 0), at(60, 30), at(80, 0)),
        ("bar", point("A"), point("B")),
        ("bar", point("D"), at(90, -40)),
        ("pivot", point("E")),
        ("bar", point("C"), at(0, 60)),
        ("pivot", point("F")),
    ):
        reply = build(text, do, *on)
        text = reply["text"]
        freedoms.append(reply["structure"]["freedom"])
        # It is drawn, and no error, before it moves.
        assert reply["scene"] and not reply["problems"]
        assert bool(reply["unfinished"]) == (freedoms[-1] != 1)
    assert freedoms == [0, 3, 2, 3, 1, 2, 0]


def test_a_point_of_an_unfinished_linkage_is_dragged():
    text = built_by(("plate", at(0, 0), at(40, 0), at(20, 30)), ("bar", point("C"), at(60, 60)))
    drag = {"handle": "point:C", "to": [25.2, 41.4], "frame": 0, "step": 0.4}
    reply = answer(text, {}, {"drag": drag})
    bodies = tomllib.loads(reply["text"])["linkage"]["bodies"]
    assert bodies["plate_1"]["C"] == bodies["bar_1"]["C"] == [25, 41.5]
    handle = next(handle for handle in reply["handles"] if handle["id"] == "point:C")
    assert handle["at"] == [25, 41.5] and reply["unfinished"] and not reply["problems"]


GALLERY = ["walking-leg", "crank-rocker", "slotted-lever", "sieve", "inch-wiper", "elliptic-trammel", "scotch-yoke",
           "oldham-coupling", "stephenson-dwell", "pantograph", "shaper", "whitworth", "walker"]  # fmt: skip


@pytest.mark.parametrize("name", by_default(GALLERY, ["inch-wiper", "sieve"]))
def test_a_dyad_on_any_linkage_is_where_it_was_drawn(name):
    text, frame = (RECIPES / f"{name}.toml").read_text(), 30
    before = gk.load(text)
    linkage = before.linkage.linkage
    joined = [p for b in list(linkage.bodies)[1:] for p in linkage.bodies[b]][-1]
    held = before.motion.point(joined).position[frame]
    size = float(linkage.size)
    place, pivot = held + size * (0.6 + 0.5j), held + size * (0.9 - 0.4j)
    clicks = [point(joined), at(pivot.real, pivot.imag), at(place.real, place.imag)]
    after = gk.load(built(Draft(text, {}), {"do": "dyad", "on": clicks, "frame": frame, "step": 0.01}))
    known = {point for points in linkage.bodies.values() for point in points}
    (new,) = {p for p, bodies in after.motion.linkage.pins.items() if p not in known and "ground" not in bodies}
    # At the driver's angle of that frame; a linkage that is no chain of dyads starts there.
    drive = before.motion.drive[frame]
    row = int(np.argmin(np.abs(after.motion.drive - drive)))
    moved = after.motion
    assert moved.drive[row] == pytest.approx(drive)
    assert abs(moved.point(new).position[row] - place) < 2e-2
    assert moved.point(joined).position[row] == pytest.approx(held, abs=1e-6 * size)


SLIDER_CRANK = (
    ("pivot", at(0, 0)),
    ("bar", point("A"), at(30, 0)),
    ("slide", point("B"), at(120, 10), at(160, 11)),
)


def test_a_bar_and_a_block_move_as_a_slider_crank():
    recipe = gk.load(built_by(*SLIDER_CRANK))
    turn = recipe.motion.drive
    expected = 30 * np.cos(turn) + np.sqrt(90**2 + 10**2 - (10 - 30 * np.sin(turn)) ** 2)
    assert np.allclose(recipe.motion.point("C").position, expected + 10j)


def test_a_block_drives_about_its_present_place():
    # With the crank at 60 and at 300 deg, which are different assembly modes.
    for frame in (60, 300):
        text = built_by(*SLIDER_CRANK)
        text = built(Draft(text, {}), {"do": "driver", "on": [body("block_1")], "frame": frame, "step": 0.4})
        recipe = gk.load(text)
        middle = len(recipe.motion.drive) // 2
        pin = recipe.motion.point("B").position
        assert recipe.stroke and abs(pin[middle] - 30 * np.exp(1j * np.radians(frame))) < 2
        assert np.allclose(np.diff(recipe.motion.point("C").position).imag, 0, atol=1e-9)
    assert gk.load(built_by(("driver", body("crank")), text=text)).stroke is None


def test_a_slotted_lever_points_at_its_pin():
    recipe = gk.load(built_by(("bar", at(0, 0), at(25, 10)), ("pivot", point("A")), ("lever", point("B"), at(0, -60))))
    motion = recipe.motion
    arm = motion.point("B").position + 60j
    assert np.allclose(motion.lever_1.direction / motion.lever_1.direction[0], arm / arm[0] / abs(arm / arm[0]))
    assert recipe.linkage.driver == "bar_1"


def test_a_pin_in_a_guide_of_the_ground_stays_on_its_line():
    text = built_by(("bar", at(0, 0), at(20, 0)), ("pivot", point("A")), ("bar", point("B"), at(90, 20)))
    recipe = gk.load(built_by(("guide", point("C"), at(120, 20)), text=text))
    assert np.allclose(recipe.motion.point("C").position.imag, 20)


@pytest.mark.parametrize("load", [("force", point("C"), at(10, -50)), ("spring", at(-40, 60), point("C"))])
def test_a_linkage_with_a_load_is_drawn_until_it_moves(load):
    text = built_by(*FOUR_BAR[:3])
    for do, *on in (("bar", point("C"), at(70, 60)), load):
        reply = build(text, do, *on)
        text = reply["text"]
        assert reply["scene"] and reply["unfinished"] and not reply["problems"]
    reply = build(text, "bar", point("D"), point("B"))
    assert not reply["problems"] and not reply["unfinished"]
    loads = gk.load(reply["text"]).loads
    assert len(loads.forces) + len(loads.springs) == 1


def test_deleting_removes_what_is_nothing_without_it():
    text = built_by(*FOUR_BAR, ("dyad", point("E"), at(100, 90), at(60, 110)), ("force", point("E"), at(30, 0)))
    (force,) = gk.load(text).loads.forces
    assert (force.body, force.point) == ("bar_1", "E") and force.force_n == (0, -10)
    text = built_by(("delete", point("G")), ("delete", point("E")), text=text)
    # The force was on that point.
    recipe = gk.load(text)
    assert recipe.loads is None and [*recipe.linkage.bodies] == ["ground", "crank", "bar_1", "bar_2"]
    reply = build(text, "delete", body("bar_2"))
    assert reply["structure"]["freedom"] == 2 and reply["unfinished"]
    text = built_by(("delete", body("crank")), text=reply["text"])
    linkage = tomllib.loads(text)["linkage"]
    assert [*linkage["bodies"]] == ["ground", "bar_1"] and "driver" not in linkage
    text = built_by(("bar", point("A"), point("C")), ("bar", point("B"), point("D")), text=text)
    assert gk.load(text).motion.assembled.all()


@pytest.mark.parametrize(("units", "mm"), [("mm", 1), ("in", 25.4)])
def test_a_spring_between_two_bodies_pulls_as_the_same_one_in_python(units, mm):
    head = EMPTY.replace("\n\n[linkage]", f'\nunits = "{units}"\n\n[linkage]')
    text = built_by(*FOUR_BAR, ("spring", at(-40, 60), point("E")), text=head)
    recipe = gk.load(text)
    (spring,) = recipe.loads.springs
    assert {spring.body, spring.to_body} == {"ground", "bar_1"} and 0 < spring.free_length < 100
    reply = answer(text, {}, {})
    (shown,) = reply["springs"]
    ends = [complex(*(row[0] if isinstance(row, list) else row for row in shown[end])) for end in ("at", "to")]
    assert abs(ends[0] - (-40 + 60j)) < 0.3 and abs(ends[1] - recipe.motion.point("E").position[0]) < 1e-3
    # The driver's torque does the work that the spring takes.
    motion = recipe.motion
    length = np.abs(motion.point("E").position - ends[0])
    energy = 0.5 * spring.stiffness * (length - spring.free_length) ** 2
    torque = np.gradient(energy, motion.drive)[1:-1]
    effort = gk.forces(motion, gk.Loads(springs=(spring,))).driver[1:-1]
    assert np.allclose(effort, torque, atol=0.01 * np.abs(torque).max())
    # It goes with its point, and alone.
    assert gk.load(built_by(("delete", point("E")), text=text)).loads is None
    without = answer(text, {}, {"set": {shown["key"]: None}})
    assert not without["springs"] and gk.load(without["text"]).loads is None


@pytest.mark.parametrize(("old", "new"), [("crank", "wheel"), ("E", "pen"), ("A", "shaft")])
def test_a_new_name_changes_no_motion(old, new):
    text = built_by(*FOUR_BAR, ("force", point("E"), at(30, 0)))
    text = answer(text, {}, {"set": {"branches.D": 1}})["text"]
    before, after = gk.load(text), gk.load(built(Draft(text, {}), {"do": "rename", "old": old, "new": new}))
    names = {*after.linkage.bodies, *(p for points in after.linkage.bodies.values() for p in points)}
    assert new in names and old not in names
    pens = [
        recipe.motion.point(name).position for recipe, name in ((before, "E"), (after, "pen" if old == "E" else "E"))
    ]
    assert np.allclose(*pens)
    # Two things may not have one name.
    with pytest.raises(gk.DesignError):
        built(Draft(text, {}), {"do": "rename", "old": old, "new": "bar_1"})


def test_a_body_with_the_name_of_a_key_is_renamed_and_deleted_and_the_key_stays():
    text = built_by(*FOUR_BAR)
    rename = [{"do": "rename", "old": "bar_2", "new": "output"}, {"do": "rename", "old": "output", "new": "lever"}]
    text = built(Draft(text, {}), rename[0])
    text = answer(text, {}, {"set": {"dwell": {"output": "output", "band_deg": 5}}})["text"]
    assert tomllib.loads(built(Draft(text, {}), rename[1]))["dwell"] == {"output": "lever", "band_deg": 5}
    text = answer(text, {}, {"set": {"dwell.output": "crank"}})["text"]
    assert tomllib.loads(built_by(("delete", body("output")), text=text))["dwell"]["output"] == "crank"


def test_inches_and_a_scale_are_those_of_the_text():
    text = EMPTY.replace("\n\n[linkage]", '\nunits = "in"\nscale = 0.5\n\n[linkage]')
    reply = build(text, "bar", at(0, 0), at(25.4, 12.7), step=0.25)
    assert tomllib.loads(reply["text"])["linkage"]["bodies"]["bar_1"]["B"] == [2, 1]
    recipe = gk.load(built_by(("pivot", point("A")), text=reply["text"]))
    assert recipe.motion.point("B").position[0] == pytest.approx(25.4 + 12.7j)


@pytest.mark.parametrize("edit", [
    {"do": "dyad", "on": [at(0, 0)]},
    {"do": "fly", "on": [at(0, 0)]},
    {"do": "bar", "on": [at(0, float("inf")), at(1, 0)]},
    {"do": "bar", "on": [at(0, 0, point="nobody"), at(1, 0)]},
    {"do": "bar", "on": [at(0, 0, point="A"), at(0, 0, point="A")]},
    {"do": "driver", "on": [at(0, 0)]},
    {"do": "spring", "on": [at(0, 0), at(9, 9)]},
    {"do": "spring", "on": [point("D"), point("E")]},
    {"do": "delete", "on": [at(0, 0, body=3)]},
    {"do": "pivot", "on": [at(0, 0)], "step": "x"},
    {"do": "pivot", "on": [at(0, 0)], "frame": None},
    {"do": "rename", "old": "A", "new": ""},
    {"do": "rename", "old": None, "new": "B"},
    {"do": "rename", "old": "A", "new": "a.b"},
    {"do": "rename", "old": "bar_1", "new": "-a"},
    {"do": ["bar"], "on": "ab"},
])  # fmt: skip
def test_an_impossible_edit_is_refused_and_changes_nothing(edit):
    text = built_by(*FOUR_BAR)
    reply = answer(text, {}, {"build": {"step": 0.4, **edit}})
    assert reply["text"] == text and reply["limit"]["reason"] and reply["scene"] and not reply["problems"]


def test_other_recipes_are_not_built():
    text = (RECIPES / "spur-gear.toml").read_text()
    reply = build(text, "pivot", at(0, 0))
    assert reply["text"] == text and "spur-gear" in reply["limit"]["reason"] and reply["structure"] is None


def test_every_edit_takes_its_number_of_clicks():
    draft = Draft(built_by(*FOUR_BAR), {})
    for do, (number, _) in EDITS.items():
        with pytest.raises(gk.DesignError):
            built(draft, {"do": do, "on": [at(200, 100)] * (number + 1)})
