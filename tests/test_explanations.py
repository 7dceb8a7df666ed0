"""What `geomkin explain` and the site say on checks and terms."""

import ast
import json
from html import unescape
from pathlib import Path
from typing import get_args

import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.core.errors import ProblemId
from geomkin.model.explanations import CHECKS, REFUSALS, TERMS, check_entry

SUMMARIES = sorted((Path(__file__).parents[1] / "out").glob("*/summary.json"))


def test_every_check_of_the_gallery_is_explained():
    ids = {check["id"] for file in SUMMARIES for check in json.loads(file.read_text("utf-8")).get("checks", ())}
    assert len(ids) > 200
    assert [id for id in sorted(ids) if check_entry(id) is None] == []


def test_every_check_of_the_code_is_explained():
    """Also those that no recipe of the gallery has; a name in braces stands for that of a part."""
    ids = set()
    for file in (SUMMARIES[0].parents[2] / "geomkin").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Check" and file.stem != "example_kind":
                first = node.args[0] if node.args else next(word.value for word in node.keywords if word.arg == "id")
                parts = first.values if isinstance(first, ast.JoinedStr) else [first]
                texts = [part.value if isinstance(part, ast.Constant) else "part_" for part in parts]
                ids |= {"".join(texts)} if any(isinstance(part, ast.Constant) for part in parts) else set()
    assert len(ids) > 70 and [id for id in sorted(ids) if check_entry(id) is None] == []


def test_every_refusal_is_explained():
    assert set(REFUSALS) == set(get_args(ProblemId)) and all(REFUSALS.values())


def test_an_entry_has_the_four_texts():
    assert all(
        set(entry) == {"name", "meaning", "limit", "remedy"} and all(entry.values()) for entry in CHECKS.values()
    )


@pytest.mark.parametrize(
    ("id", "entry"),
    [
        ("stage_1_contact_ratio", "contact_ratio"),
        ("wall_rocker", "wall"),
        ("pressure_angle_rise", "pressure_angle"),
        ("train_driven_1_root_safety", "root_safety"),
        ("transmission_angles", None),
    ],
)
def test_names_of_parts_do_not_matter(id, entry):
    assert check_entry(id) == entry


def test_the_command_explains_checks_and_terms_and_refuses_others():
    runner = CliRunner()
    for known in ("wall_rocker", "base circle", "Grashof's condition"):
        assert runner.invoke(cli, ["explain", *known.split()]).exit_code == 0
    odd = runner.invoke(cli, ["explain", "\x1b[31m_wall_"])
    assert odd.exit_code == 0 and "\x1b" not in odd.output
    both = runner.invoke(cli, ["explain", "wall_rocker", "out-of-range"]).output
    assert CHECKS["wall"]["remedy"] in both and REFUSALS["out-of-range"] in both
    wrong = runner.invoke(cli, ["explain", "transmision_angle"])
    assert wrong.exit_code == 2 and "transmission_angle" in wrong.output
    part = runner.invoke(cli, ["explain", "grashof"])
    assert part.exit_code == 0 and TERMS["Grashof's condition"] in part.output
    several = runner.invoke(cli, ["explain", "pressure"])
    assert several.exit_code == 2 and "pressure angle" in several.output and "pin_pressure" in several.output
    assert len(TERMS) >= 30


def test_examples_are_those_with_all_words():
    runner = CliRunner()
    every = runner.invoke(cli, ["examples"]).output.splitlines()
    assert len(every) == 1 + len([*(SUMMARIES[0].parents[2] / "recipes").glob("*.toml")])
    found = runner.invoke(cli, ["examples", "springs", "FRICTION"]).output.splitlines()[1:]
    assert found and {line.split()[0] for line in found} < {line.split()[0] for line in every}
    for line in found:
        text = (SUMMARIES[0].parents[2] / "recipes" / line.split()[0]).read_text("utf-8").casefold()
        assert "spring" in text and "friction" in text
    wrong = runner.invoke(cli, ["examples", "\x1bunicorn"])
    assert wrong.exit_code == 2 and "\x1b" not in wrong.output


def test_a_page_explains_its_checks(tmp_path):
    recipe = gk.load('kind = "spur-gear"\n[gear]\nteeth = 9\nmodule = 2\n')
    gk.make(recipe, tmp_path, ["page"])
    (page,) = tmp_path.rglob("*.html")
    text = unescape(page.read_text("utf-8"))
    assert any(not check.passed for check in recipe.checks)
    assert all(CHECKS[check_entry(check.id)]["remedy"] in text for check in recipe.checks)
