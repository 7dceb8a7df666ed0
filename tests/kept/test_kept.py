"""Every recipe of the net gives what was kept of it; `net.py` says what that is for, and how it is rewritten."""

import itertools
import json
import tomllib

import pytest

from tests.kept import calls, net, scenes, texts

KEPT = net.kept()
RECIPES = net.recipes()
# Every other of those that are made; all that are refused, which takes no time. All are made in campaigns, and when the
# net is written anew.
TRIED = [
    pytest.param(name, marks=pytest.mark.campaign if k % 2 and "refused" not in found else ())
    for k, (name, found) in enumerate(KEPT.items())
]


@pytest.mark.parametrize("name", TRIED)
def test_a_recipe_gives_what_was_kept_of_it(tmp_path, name):
    found = json.loads(json.dumps(net.outcome(name, *RECIPES[name], tmp_path)))
    assert "\n".join(net.differences(KEPT[name], found)) == ""


SHOWN = scenes.kept()
SHOWN_RECIPES = scenes.recipes()


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.campaign if k % 2 else ()) for k, n in enumerate(SHOWN)]
)
def test_a_recipe_looks_as_it_was_kept(tmp_path, name):
    found = json.loads(json.dumps(scenes.outcome(name, *SHOWN_RECIPES[name], tmp_path)))
    assert "\n".join(net.differences(SHOWN[name], found)) == ""


def test_every_scene_has_its_kept_result():
    assert list(SHOWN) == list(SHOWN_RECIPES)


def test_every_recipe_has_its_kept_result():
    assert list(KEPT) == list(RECIPES)


MADE = [name for name, found in KEPT.items() if "refused" not in found]


def named():
    """All kinds, as the command lists them."""
    return {line.split()[0] for line in texts.outcome("list")[1:]}


def test_the_net_is_wide():
    kinds = {tomllib.loads(RECIPES[name][0])["kind"] for name in MADE}
    # A path's search ends in a flat valley, where the last digits that are kept hang on the processor.
    assert kinds == named() - {"path-generator"} and len(MADE) >= 200 and len(KEPT) - len(MADE) >= 100


@pytest.mark.parametrize("name", MADE)
def test_kept_numbers_are_such_as_can_be(name):
    """A net that was rewritten after a bad slip would keep it: areas, counts and sheets say the plainest."""
    found = KEPT[name]
    for part in found["parts"].values():
        about = dict(itertools.pairwise(part))
        assert about["count"] >= 1 and about["area_mm2"] > 0
        assert about["volume_mm3"] == pytest.approx(about["area_mm2"] * about["thickness_mm"], rel=1e-7)
        if "written_volume_mm3" in about:
            assert about["written_volume_mm3"] == pytest.approx(about["volume_mm3"], rel=0.1)
    for header, (rows, there, *told) in found.get(".csv", {}).items():
        if told and isinstance(there, int):
            scale, first, last, least, largest, _ = told
            assert least <= min(first, last) <= max(first, last) <= largest and 1 <= there <= rows, header
            assert scale == max(abs(least), abs(largest)), header
    if ".dxf" in found:
        left, low, right, high = found[".dxf"]["extents"]
        outlines = sum(
            part["area_mm2"] * part["count"] for p in found["parts"].values() if (part := dict(itertools.pairwise(p)))
        )
        assert (right - left) * (high - low) > 0.9 * outlines


CALLED = calls.kept()


@pytest.mark.parametrize("call", calls.calls())
def test_a_call_gives_what_was_kept_of_it(call):
    found = json.loads(json.dumps(calls.outcome(call)))
    assert "\n".join(calls.differences(CALLED[call], found)) == ""


def test_every_call_has_its_kept_result():
    assert list(CALLED) == calls.calls()


PRINTED = texts.kept()


@pytest.mark.parametrize("command", PRINTED)
def test_a_command_prints_what_was_kept_of_it(command):
    assert texts.differences(PRINTED[command], texts.outcome(command)) == ""


def test_every_command_has_its_kept_text():
    assert list(PRINTED) == list(texts.commands())
    assert {command.split()[1] for command in PRINTED if command.startswith("new ")} >= named()
