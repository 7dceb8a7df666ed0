"""Faults put into the source one at a time, and whether a test sees them.

    pip install -e '.[test]' coverage
    python tests/mutation/campaign.py map            # once, minutes: which tests run which line
    python tests/mutation/campaign.py run 200 7      # 200 faults chosen by seed 7, two at a time
    python tests/mutation/campaign.py one geomkin/gear/ring.py:152

Each fault is one change of one operator, number, name, sign or condition of a random line. In a copy of the project the
tests that run the line are run until one fails, the quickest first, for so many seconds. What survives is tried again
with all tests that run the line, the folder of tests that has the name of the source's folder, the kept results, the
kept drawings, and that folder's campaigns.
What then survives is for a person to judge: some changes alter nothing that can be seen (an equal bound, a message's
wording, an example's size, a speed). The first round takes
some 5 seconds a fault, the second a minute or more a survivor. With numba beside it the compiled engine is tried, too.

The map leaves out the tests that work in processes of their own for long (kills, same bytes), so a fault that only they
would see is printed as a survivor. After tests are renamed the map has to be drawn again: a test that is not found
looks like one that fails.
"""

import ast
import concurrent.futures
import contextlib
import functools
import json
import os
import queue
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import coverage

ROOT = Path(__file__).parent.parent.parent
MAP = ROOT / ".mutation"
LEFT_OUT = ["tests/hostile/test_kills.py", "tests/hostile/test_same_bytes.py", "tests/test_recipes.py"]
GALLERY = "tests/test_recipes.py"
# The kept results read nearly every line, those that are run while the source is imported among them, which the map
# puts down to whichever test came first.
NET = "tests/kept"
# Reads what is written where classes are made, so it is tried for every line that is run while the source is imported.
AT_IMPORT = "tests/test_quantities.py"
# Of the tests that run a line, as many as take this long together are tried first: more, and a survivor costs minutes.
SECONDS = 15
# Seconds after which tests of a second look count as hanging: campaigns of one folder take up to ten minutes.
LONGEST = 3600
# A fault that asks for more than this fails instead of taking the machine down.
MEMORY = 6 << 30
COMPARISONS = {ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">", ast.Eq: "!=", ast.NotEq: "==", ast.In: "not in",
               ast.NotIn: "in", ast.Is: "is not", ast.IsNot: "is"}  # fmt: skip
OPERATORS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.Pow: "*", ast.BitAnd: "|", ast.BitOr: "&",
             ast.FloorDiv: "/", ast.Mod: "*"}  # fmt: skip
NAMES = {"min": "max", "max": "min", "cos": "sin", "sin": "cos", "real": "imag", "imag": "real", "any": "all",
         "all": "any", "minimum": "maximum", "maximum": "minimum", "floor": "ceil", "ceil": "floor",
         "argmin": "argmax", "argmax": "argmin"}  # fmt: skip


def draw_map():
    """Run the suite once and note which test runs which line, and each test's seconds."""
    shutil.rmtree(MAP, ignore_errors=True)
    MAP.mkdir()
    left_out = [f"--ignore={file}" for file in LEFT_OUT]
    plugin = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}
    subprocess.run([sys.executable, "-m", "pytest", "-p", "drawing", "-n", "2", *left_out], cwd=ROOT, env=plugin)


def faults(file):
    """(line, bytes from and to, new text) for every small change of a source file."""
    raw = file.read_bytes()
    tree = ast.parse(raw)
    starts = [0]
    for line in raw.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    # What is written about types alters nothing.
    types = {id(n) for node in ast.walk(tree) for kind in ("annotation", "returns")
             if (about := getattr(node, kind, None)) for n in ast.walk(about)}  # fmt: skip
    for node in (node for node in ast.walk(tree) if id(node) not in types):
        for (row, column), (last_row, last_column), text in _changes(node):
            begin, end = starts[row - 1] + column, starts[last_row - 1] + last_column
            if isinstance(node, ast.Compare | ast.BinOp | ast.UnaryOp | ast.BoolOp):
                # Between two operands there may be brackets, which belong to neither: only what is between those goes.
                text = re.sub(r"[^()\s]([^()]*[^()\s])?", text, raw[begin:end].decode(), count=1)
            changed = raw[:begin] + text.encode() + raw[end:]
            try:
                ast.parse(changed)
            except SyntaxError:
                continue
            yield row, (begin, end), text


def _changes(node):
    """(place, place, new text) for what a slip of the hand makes of one node."""
    match node:
        case ast.Compare(ops=[one]) if type(one) in COMPARISONS:
            yield _end(node.left), _start(node.comparators[0]), COMPARISONS[type(one)]
        case ast.BinOp() if type(node.op) in OPERATORS:
            yield _end(node.left), _start(node.right), OPERATORS[type(node.op)]
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield _start(node), _start(node.operand), ""
        case ast.BoolOp():
            yield _end(node.values[0]), _start(node.values[1]), "or" if isinstance(node.op, ast.And) else "and"
        case ast.Constant(value=bool()):
            yield _start(node), _end(node), str(not node.value)
        case ast.Constant(value=int() | float()):
            yield (
                _start(node),
                _end(node),
                repr(node.value + 1 if isinstance(node.value, int) else node.value * 1.5 or 1.0),
            )
        case ast.Attribute() if node.attr in NAMES:
            row, column = _end(node)
            yield (row, column - len(node.attr)), (row, column), NAMES[node.attr]
        case ast.Name() if node.id in ("min", "max", "any", "all"):
            yield _start(node), _end(node), NAMES[node.id]
        case ast.IfExp():
            yield _start(node.test), _end(node.test), "True"


def _start(node):
    return node.lineno, node.col_offset


def _end(node):
    return node.end_lineno, node.end_col_offset


@functools.cache
def tests_by_line(file):
    """{line: names of the tests that run it}; a test file's own name stands for what it runs at import."""
    found = {}
    for part in MAP.glob("map.*"):
        data = coverage.CoverageData(part)
        data.read()
        for line, contexts in data.contexts_by_lineno(str(ROOT / file)).items():
            found.setdefault(line, set()).update(context for context in contexts if context)
    return found


def quickest(names, seconds, folder):
    """The tests that are tried, and how long they take: the source's own folder first, quick ones first."""
    chosen, total = [], 0
    for name in sorted(names, key=lambda n: (not n.startswith(folder), seconds.get(n, SECONDS / 4), n)):
        if total + seconds.get(name, SECONDS / 4) < SECONDS:
            chosen.append(name)
            total += seconds.get(name, SECONDS / 4)
    return chosen, total


def try_fault(home, file, fault, seconds):
    """What became of a fault in the copy at `home`: "caught", "survived" or "not run" by any test of the map."""
    folder = f"tests/{Path(file).parts[1]}"
    names = tests_by_line(file).get(fault[0], set())
    chosen, expected = quickest(names, seconds, folder)
    if any("::" not in name for name in names):
        chosen.append(AT_IMPORT)
    own = [name for name in chosen if name.startswith(folder)]
    rounds = own, [name for name in chosen if name not in own]
    if not chosen:
        return "not run"
    with put(home, file, fault):
        return "survived" if all(_pass(home, tests, 60 + 10 * expected) for tests in rounds) else "caught"


def look_again(home, file, fault):
    """Try a survivor with all tests that run the line and those of its name, then with the kept ones and campaigns."""
    room = Path(file).parts[1]
    folder = f"tests/{room}" if (home / "tests" / room).is_dir() else f"tests/test_{room}"
    named = [folder] * (home / folder).exists()
    tests = sorted(name for name in tests_by_line(file).get(fault[0], ()) if not name.startswith((folder, NET)))
    with put(home, file, fault):
        for what, again in (
            ("at the second look", [*named, AT_IMPORT, *tests]),
            ("by the kept results", [NET]),
            ("by the kept drawings only", [GALLERY]),
            ("by the campaigns only", [*named, "-m", "campaign"] if named else []),
        ):
            if not _pass(home, again, LONGEST):
                return f"caught {what}"
        return "survived"


@contextlib.contextmanager
def put(home, file, fault):
    """A fault put into the copy, and taken out again."""
    _, (begin, end), text = fault
    original = (ROOT / file).read_bytes()
    (home / file).write_bytes(original[:begin] + text.encode() + original[end:])
    try:
        yield
    finally:
        (home / file).write_bytes(original)


def _pass(home, tests, limit):
    """Whether tests pass within a time: a fault that hangs is seen, too."""
    if not tests:
        return True
    command = [sys.executable, "-m", "pytest", "-x", "-p", "no:cacheprovider", *tests]
    environment = os.environ | {"PYTHONPATH": str(home)}
    with subprocess.Popen(
        command, cwd=home, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT
    ) as job:
        try:
            return job.wait(limit) in (0, 5)  # 5: nothing was left to run
        except subprocess.TimeoutExpired:
            job.kill()
            return False


def shown(file, fault):
    line, (begin, end), text = fault
    raw = (ROOT / file).read_bytes()
    low, high = raw.rfind(b"\n", 0, begin) + 1, raw.find(b"\n", end)
    after = raw[low:begin] + text.encode() + raw[end:high]
    return f"{file}:{line}\n  - {raw[low:high].decode().strip()}\n  + {after.decode().strip()}"


def work(jobs):
    """Try (file, fault) two at a time, then what survived once more with more tests; say which, and count."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    seconds = json.loads((MAP / "seconds.json").read_text())
    skip = shutil.ignore_patterns(".venv", ".git", ".mypy_cache", ".ruff_cache", MAP.name)
    homes = queue.SimpleQueue()

    def in_a_home(attempt, file, fault, *more):
        home, start = homes.get(), time.time()
        verdict = attempt(home, file, fault, *more)
        homes.put(home)
        print(f"{verdict} ({time.time() - start:.0f} s): {shown(file, fault)}", flush=True)
        return verdict

    with tempfile.TemporaryDirectory() as room, concurrent.futures.ThreadPoolExecutor(2) as pool:
        for name in "ab":
            homes.put(Path(shutil.copytree(ROOT, Path(room) / name, ignore=skip)))
        first = list(pool.map(lambda job: in_a_home(try_fault, *job, seconds), jobs))
        print(dict(Counter(first)), "; those not caught again:", flush=True)
        left = [job for job, verdict in zip(jobs, first, strict=True) if verdict != "caught"]
        print(dict(Counter(pool.map(lambda job: in_a_home(look_again, *job), left))))


def run(count, seed):
    """Try faults of random lines, one a line."""
    by_line = {}
    for path in sorted((ROOT / "geomkin").rglob("*.py")):
        file = path.relative_to(ROOT).as_posix()
        for fault in faults(path):
            by_line.setdefault((file, fault[0]), []).append(fault)
    rng = random.Random(seed)
    work([(file, rng.choice(by_line[file, line])) for file, line in rng.sample(sorted(by_line), count)])


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["map"]:
            draw_map()
        case ["run", count, seed]:
            run(int(count), int(seed))
        case ["one", place]:
            file, line = place.split(":")
            work([(file, fault) for fault in faults(ROOT / file) if fault[0] == int(line)])
        case _:
            print(__doc__)
