"""What `geomkin explain` and the site say on checks and terms."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from geomkin.cli import cli
from geomkin.cli.explanations import CHECKS, TERMS, check_entry

SUMMARIES = sorted((Path(__file__).parents[1] / "out").glob("*/summary.json"))


def test_every_check_of_the_gallery_is_explained():
    ids = {check["id"] for file in SUMMARIES for check in json.loads(file.read_text("utf-8")).get("checks", ())}
    assert len(ids) > 200
    assert [id for id in sorted(ids) if check_entry(id) is None] == []


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
    wrong = runner.invoke(cli, ["explain", "transmision_angle"])
    assert wrong.exit_code == 2 and "transmission_angle" in wrong.output
    assert len(TERMS) >= 30
