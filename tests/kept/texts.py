"""The net's third part: what the command prints, word by word: templates of every kind, lists and refusals.

What such a net is for, `net.py` says. A change that is meant is written down with

    python -m tests.kept.texts
"""

import contextlib
import difflib
import hashlib
import json
import re
import tempfile
from pathlib import Path

from click.testing import CliRunner

from geomkin.commands import cli

HERE = Path(__file__).parent
# Tables of another kind than the usual one, and tables that may be left out.
WISHES = {
    "disk-cam": [
        *(f"follower={kind}" for kind in ("translating-flat", "oscillating-roller", "oscillating-flat")),
        *(f"program={kind}" for kind in ("polynomial", "optimised-polynomial", "optimised-spline", "spline", "table")),
    ],
    "linkage": ["sliders", "stroke"],
    "polygons": ["sliders"],
    "slider-crank": ["stroke"],
    "elliptic-trammel": ["stroke"],
    "spur-gear": ["web"],
    "planetary": ["web", "sun_stock.web"],
}
REFUSED = [
    "new foo", "new", "new four-barr", "new four-bar --with web", "new spur-gear --with wep", "new linkage --with sliders=x",
    "new disk-cam --with follower", "new disk-cam --with follower=roller", "run", "check", "run nowhere.toml", "foo",
    "run . --only pdf", "run .", "run . --only dxf,",
]  # fmt: skip


# Recipes that are run and checked: one that passes, one whose check fails, one that is refused, and slips of the hand.
_BAR = "[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = {}\n[files]\nwrite = ['csv', 'svg']\n"
_SLIP = 'kind = "four-bar"\n[linkage]\nground = {}\n'
RECIPES = {
    "good": 'kind = "four-bar"\n' + _BAR.format(70),
    "poor": 'kind = "four-bar"\n' + _BAR.format(41),
    "bad": 'kind = "four-bar"\n' + _BAR.format(-1),
    "curly": _SLIP.format("\u201c100\u201d"),
    "nothing": _SLIP.format(""),
    "yes": _SLIP.format("Yes"),
    "off": _SLIP.format("off"),
    "word": _SLIP.format("long"),
    "comma": _SLIP.format("1,5"),
    "inch": _SLIP.format("4 inch"),
    "point": _SLIP.format(".5 mm"),
    "open": 'kind = "four-bar\n',
    "number": "[linkage]\nground = 100.\n",
}
RUNS = [
    "run good.toml", "run good.toml poor.toml", "run good.toml bad.toml --only csv", "run good.toml --only stl", "check good.toml poor.toml",
    "check bad.toml", "run good.toml in/good.toml", "run in", "check .", "run good.toml --out other",
]  # fmt: skip


def commands():
    """What the command is asked; the kinds are those that it lists."""
    yield from ["list", "schema"]
    yield from (f"new {line.split()[0]}" for line in outcome("list")[1:])
    yield from (f"new {kind} --with {wish}" for kind, wishes in WISHES.items() for wish in wishes)
    yield "new disk-cam --with follower=oscillating-flat --with program=table"
    yield from REFUSED
    yield from RUNS


def kept():
    return json.loads((HERE / "texts.json").read_text("utf-8"))


def outcome(command):
    """Exit code and lines; of the schema, which is long, digests of what it defines; of a refusal the error itself."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        if command in RUNS:
            Path("in").mkdir()
            for name, text in RECIPES.items():
                Path(f"{name}.toml").write_text(text, "utf-8")
            Path("in/good.toml").write_text(RECIPES["good"], "utf-8")
        done = CliRunner().invoke(cli, command.split(), prog_name="geomkin")
    # Sizes of files hold the names of libraries' versions.
    lines = re.sub(r"[\d,]+ kB", "some kB", done.output).splitlines()
    if command == "schema":
        return [done.exit_code, *_digests(json.loads(done.output))]
    # How a wrong use is introduced is for the library that reads the command line to say.
    return [done.exit_code, *(lines[-1:] if done.exit_code == 2 else lines)]


def _digests(held, path="", depth=2):
    for key, inner in held.items():
        if isinstance(inner, dict) and depth:
            yield from _digests(inner, f"{path}/{key}", depth - 1)
        else:
            yield f"{path}/{key} {hashlib.sha256(json.dumps(inner, sort_keys=True).encode()).hexdigest()[:12]}"


def differences(old, new):
    return "\n".join(difflib.unified_diff([str(line) for line in old], [str(line) for line in new], n=0, lineterm=""))


def main():
    before = kept() if (HERE / "texts.json").exists() else {}
    found = {command: outcome(command) for command in commands()}
    for command, lines in found.items():
        if told := differences(before.get(command, []), lines):
            print(f"{command}:\n{told}")
    text = json.dumps(found, ensure_ascii=False, indent=1)
    (HERE / "texts.json").write_text(text + "\n", "utf-8")


if __name__ == "__main__":
    main()
