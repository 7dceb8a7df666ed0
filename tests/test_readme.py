"""README.md and docs/ are true: their code runs, the numbers in its comments hold, their links and pictures exist."""

import ast
import io
import re
import shlex
import shutil
import tokenize
from contextlib import chdir
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from tests.campaign import by_default

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
# Numbers at the start of a comment, such as `True, 11.3027 mm`; in `1/mm` the number belongs to the unit.
CLAIM = r"(?:True|False|-?\d+(?:\.\d+)?)(?![\w/.])"
CLAIMS = re.compile(rf"# *({CLAIM}(?:[\w ]*, {CLAIM})*)")


def run_commands(block):
    """The commands of a block that begin with `geomkin`; `> file` writes the output."""
    for line in block.replace("\\\n", "").splitlines():
        command, _, file = line.partition(" > ")
        if command.startswith("geomkin "):
            result = CliRunner().invoke(cli, shlex.split(command)[1:])
            assert result.exit_code == 0, (line, result.output)
            if file:
                Path(file).write_text(result.output)


def run_python(block, names):
    """Each statement; an expression whose comment begins with numbers must have them, to the digits written."""
    comments = {
        token.start[0]: token.string
        for token in tokenize.generate_tokens(io.StringIO(block).readline)
        if token.type == tokenize.COMMENT
    }
    for node in ast.parse(block).body:
        if not isinstance(node, ast.Expr):
            exec(compile(ast.Module([node], []), "block", "exec"), names)
            continue
        value = eval(compile(ast.Expression(node.value), "block", "eval"), names)
        claims = CLAIMS.match(comments.get(node.end_lineno, ""))
        if claims:
            stated = re.findall(CLAIM, claims[1])
            found = np.ravel(value)
            assert len(found) == len(stated), (ast.unparse(node), value)
            for number, text in zip(found, stated, strict=True):
                if text in ("True", "False"):
                    assert bool(number) is (text == "True"), ast.unparse(node)
                else:
                    digits = len(text.partition(".")[2])
                    assert number == pytest.approx(float(text), abs=0.51 * 10.0**-digits), ast.unparse(node)


# Pages whose code takes long; the README's command is that of the test at the end.
LONG = {"README", "synthesis", "files", "optimisation", "recipes", "forces", "library"}


@pytest.mark.parametrize(
    "page", by_default(PAGES, [page for page in PAGES if page.stem not in LONG]), ids=lambda page: page.stem
)
def test_code_of_page_runs(page, tmp_path, monkeypatch):
    shutil.copytree(ROOT / "recipes", tmp_path / "recipes")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "page"}
    for language, block in re.findall(
        r"^```(sh|python|toml)\n(.*?)^```", page.read_text("utf-8"), re.DOTALL | re.MULTILINE
    ):
        if language == "sh":
            run_commands(block)
        elif language == "python":
            run_python(block, names)
        else:
            recipe = gk.load(block)
            assert {check.id for check in recipe.checks if not check.passed} == set(recipe.expected_failures)


def anchor(heading):
    """The anchor that GitHub gives a heading."""
    return re.sub(r"[^\w -]", "", heading.strip().lower()).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_and_pictures_exist(page):
    text = page.read_text("utf-8")
    targets = re.findall(r'src="([^"]+)"', text) + re.findall(r"\]\(([^)\s]+)\)", text)
    for target in targets:
        file, _, name = target.partition("#")
        # Generated pages exist in the site, whose build checks links to them.
        if not target.startswith(("https://", "generated/")):
            linked = (page.parent / file).resolve() if file else page
            assert linked.exists(), target
            if name:
                headings = re.findall(r"^#+ (.*)$", linked.read_text("utf-8"), re.MULTILINE)
                assert name in map(anchor, headings), target


def test_readme_is_short_and_starts_with_the_two_commands():
    text = PAGES[0].read_text("utf-8")
    assert len(text.splitlines()) <= 120
    gallery, tests, *_ = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
    assert "geomkin run recipes" in gallery and "pytest" in tests


def test_the_readme_shows_what_is_printed(tmp_path):
    """Except the size of the files, which changes with the page."""
    (shown, *_) = re.findall(r"```text\n(.*?)```", PAGES[0].read_text("utf-8"), re.DOTALL)
    recipe = str(PAGES[0].parent / "recipes/spur-gear.toml")
    with chdir(tmp_path):
        printed = CliRunner().invoke(cli, ["run", recipe]).stdout
    assert [re.sub(r"\d+ kB$", "", line) for line in printed.splitlines()] == [
        re.sub(r"\d+ kB$", "", line) for line in shown.splitlines()
    ]
