"""What differs between systems: text is read and written as UTF-8 by name, and processes may be started afresh."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
# Every file that geomkin opens without an encoding would have that of the system, which on Windows is not UTF-8.
COMMANDS = """
import sys, warnings
warnings.filterwarnings("error", category=EncodingWarning, module="geomkin")
from geomkin.cli import cli
from geomkin.core import processes
if __name__ == "__main__":
    processes.METHOD = "spawn"
    processes.worker_count = lambda: 2
    recipes, out = sys.argv[1:]
    for words in (
        ["run", f"{recipes}/crank-rocker.toml", f"{recipes}/gear-pair.toml", "--out", out, "--verify"],
        ["sweep", f"{recipes}/crank-rocker.toml", "--set", "linkage.crank=20,25", "--out", out],
        ["verify", f"{out}/gear-pair"],
        ["examples", "dwell"],
        ["new", "four-bar"],
        ["explain", "crank"],
    ):
        try:
            cli(words, standalone_mode=False)
        except SystemExit as end:
            assert not end.code, words
"""


@pytest.mark.campaign
def test_commands_name_encodings_and_start_new_processes(tmp_path):
    script = tmp_path / "commands.py"
    script.write_text(COMMANDS, encoding="utf-8")
    words = [sys.executable, "-X", "warn_default_encoding", str(script), str(ROOT / "recipes"), str(tmp_path / "out")]
    ended = subprocess.run(words, capture_output=True, text=True, encoding="utf-8", cwd=tmp_path, check=False)
    assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "out/gear-pair/verify.json").is_file()


def test_files_are_opened_with_an_encoding():
    """No `read_text` or `write_text` of the package leaves its encoding to the system."""
    wrong = []
    for file in (ROOT / "geomkin").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                named = {word.arg for word in node.keywords}
                given = len(node.args) + ("encoding" in named)
                if (node.func.attr == "read_text" and given < 1) or (node.func.attr == "write_text" and given < 2):
                    wrong.append(f"{file.name}:{node.lineno}")
    assert wrong == []
