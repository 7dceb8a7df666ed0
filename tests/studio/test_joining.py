"""Mechanisms put on shafts: the text of a machine that turns as its gears say."""

import tomllib

import numpy as np
import pytest

import geomkin as gk
from geomkin.studio.edit import answer
from tests.campaign import by_default

from ..browser.test_editor import RECIPES

FILES = {
    f"{name}.toml": (RECIPES / f"{name}.toml").read_text() for name in ("gear-pair", "walking-leg", "crank-rocker")
}


def join(text, name="it", **wanted):
    return answer(text, FILES, {"join": wanted}, name)


def test_a_leg_is_turned_by_the_second_gear():
    reply = join(FILES["gear-pair.toml"], "pair", recipe="crank-rocker", turned_by="second", phase_deg=90)
    assert reply["limit"] is None and not reply["problems"] and reply["kind"] == "machine"
    shafts = {shaft["body"]: complex(*shaft["at"]) for shaft in reply["shafts"]}
    pair = gk.load(FILES["gear-pair.toml"])
    assert shafts["pair.second"] == shafts["crank-rocker.crank"] == pytest.approx(1j * pair.design.centre_distance)
    mechanisms = tomllib.loads(reply["text"])["mechanisms"]
    assert mechanisms["crank-rocker"] == {"turned_by": "pair.second", "phase_deg": 90, "recipe": "crank-rocker.toml"}
    # The gear pair is as it was.
    assert mechanisms["pair"]["recipe"] == tomllib.loads(FILES["gear-pair.toml"])


def test_another_mechanism_of_a_machine_gets_a_name_of_its_own():
    text = (RECIPES / "spur-gear.toml").read_text()
    assert join(text, kind="four-bar", turned_by="gear")["limit"]
    reply = join(FILES["crank-rocker.toml"], "", kind="four-bar", turned_by="crank")
    assert [*tomllib.loads(reply["text"])["mechanisms"]] == ["four-bar", "four-bar-2"]
    reply = join(reply["text"], kind="disk-cam", turned_by="four-bar-2.crank")
    assert tomllib.loads(reply["text"])["mechanisms"]["disk-cam"]["turned_by"] == "four-bar-2.crank"
    assert not reply["problems"] and len(reply["scene"]["scenes"][0]["bodies"]) > 8


KINDS = [
    "crank-rocker",
    "roller-cam",
    "planetary",
    "gear-train",
    "geneva",
    "belt-drive",
    "cycloidal-drive",
    "ratchet",
    "inch-wiper",
]


@pytest.mark.parametrize("name", by_default(KINDS, ["inch-wiper"]))
def test_every_mechanism_with_a_shaft_turns_another(name):
    text = (RECIPES / f"{name}.toml").read_text()
    shaft = answer(text, {}, {})["shafts"][-1]
    reply = join(text, kind="four-bar", turned_by=shaft["body"])
    assert reply["limit"] is None and not reply["problems"]
    crank = next(other for other in reply["shafts"] if other["body"] == "four-bar.crank")
    assert np.allclose(crank["at"], next(s["at"] for s in reply["shafts"] if s["body"] == f"it.{shaft['body']}"))
    assert tomllib.loads(reply["text"]).get("units", "mm") == tomllib.loads(text).get("units", "mm")


@pytest.mark.parametrize("name", ["wiper.found", "leg (copy)", "..", "my_leg", "it"])
def test_a_mechanism_has_a_name_of_letters_whatever_its_file_is_called(name):
    files = {f"{name}.toml": FILES["crank-rocker.toml"]}
    reply = answer(FILES["gear-pair.toml"], files, {"join": {"recipe": name, "turned_by": "second"}}, name)
    assert reply["limit"] is None and not reply["problems"]
    assert [held["recipe"] for held in tomllib.loads(reply["text"])["mechanisms"].values()][1] == f"{name}.toml"


@pytest.mark.parametrize(
    "wanted", [{}, {"kind": "four-bar"}, {"kind": "four-bar", "turned_by": "third"}, {"kind": "x", "turned_by": "second"},
               {"kind": "spur-gear", "turned_by": "second"}, {"recipe": "nothing", "turned_by": "second"},
               {"recipe": ["a"], "turned_by": "second"}, {"kind": "four-bar", "turned_by": "second", "phase_deg": "x"},
               {"kind": "four-bar", "turned_by": ["second"]}, "x", 5]
)  # fmt: skip
def test_an_impossible_join_is_refused_and_changes_nothing(wanted):
    text = FILES["gear-pair.toml"]
    reply = answer(text, FILES, {"join": wanted} if wanted else {"join": {"kind": ""}})
    assert reply["text"] == text and reply["limit"]["reason"] and reply["scene"]


@pytest.mark.parametrize("units", ["mm", "inch"])
def test_a_gear_on_a_crank_gets_the_bore_of_its_shaft(units):
    text = (RECIPES / "inch-wiper.toml").read_text() if units == "inch" else FILES["walking-leg.toml"]
    (shaft, *_) = answer(text, {}, {})["shafts"]
    reply = join(text, kind="gear-pair", turned_by=shaft["body"])
    assert not reply["problems"]
    machine = gk.load(reply["text"])
    (fit,) = machine.shafts
    bores = [bore.diameter for bore in fit.bores.values()]
    assert len(bores) == 2 and bores[0] == pytest.approx(bores[1]) and bores[0] > 1
    # Without it the check says what to do.
    bare = tomllib.loads(reply["text"])
    del bare["mechanisms"]["gear-pair"]["recipe"]["first_stock"]
    (check,) = (check for check in gk.load(bare).design_checks if check.id.endswith("_bores"))
    assert check.value == 1 and not check.passed and "gear-pair/first" in check.advice


@pytest.mark.parametrize("name", ["klann", "inch-wiper"])
def test_a_text_of_the_gallery_is_joined_with_its_sizes_in_the_unit_of_the_machine(name):
    source = (RECIPES / f"{name}.toml").read_text()
    wanted = {"source": source, "name": name, "turned_by": "second"}
    reply = answer(FILES["gear-pair.toml"], {}, {"join": wanted})
    assert not reply["problems"] and reply["limit"] is None
    held, alone = gk.load(reply["text"]).mechanisms[name].recipe, gk.load(source)
    one, other = (recipe.linkage.linkage.bodies for recipe in (held, alone))
    assert [*one] == [*other]
    for body, points in other.items():
        assert {point: complex(z) for point, z in one[body].items()} == pytest.approx(
            {point: complex(z) for point, z in points.items()}, abs=1e-6
        )
