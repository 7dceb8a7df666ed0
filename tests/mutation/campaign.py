"""Faults put into the source one at a time, and whether the tests that run the faulty line see them.

    pip install coverage
    python tests/mutation/campaign.py map            # once: which tests run which line (minutes)
    python tests/mutation/campaign.py run 200 7      # 200 faults chosen by seed 7, two at a time
    python tests/mutation/campaign.py one geomkin/gear/ring.py:152

Each fault is one change of one operator, number, name of a comparison, sign or condition of a random line. The tests
that run the line are run in a copy of the project until one fails. What survives is printed with its change, for a
person to judge: some changes alter nothing that can be seen (an equal bound, a message's wording, a speed).
"""

import ast
import concurrent.futures
import json
import os
import random
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
MAP = ROOT / ".coverage"
# Tests tried for a fault, quickest to reach first, and the time they get: a fault that hangs is seen, too.
MOST_TESTS, SECONDS = 80, 240
COMPARISONS = {ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">", ast.Eq: "!=", ast.NotEq: "==", ast.In: "not in",
               ast.NotIn: "in", ast.Is: "is not", ast.IsNot: "is"}  # fmt: skip
OPERATORS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.Pow: "*", ast.BitAnd: "|", ast.BitOr: "&",
             ast.FloorDiv: "/", ast.Mod: "*"}  # fmt: skip
NAMES = {"min": "max", "max": "min", "cos": "sin", "sin": "cos", "real": "imag", "imag": "real", "any": "all",
         "all": "any", "minimum": "maximum", "maximum": "minimum", "floor": "ceil", "ceil": "floor",
         "argmin": "argmax", "argmax": "argmin"}  # fmt: skip


def draw_map():
    """Run the whole suite once and note which test runs which line."""
    settings = ROOT / ".mutation-coverage"
    settings.write_text("[run]\nsource = geomkin\ndynamic_context = test_function\nparallel = True\n")
    try:
        command = [sys.executable, "-m", "coverage", "run", f"--rcfile={settings}", "-m", "pytest", "-p", "no:randomly"]
        rooms = sorted(p.relative_to(ROOT).as_posix() for p in (ROOT / "tests").iterdir() if any(p.glob("test_*.py")))
        others = ["tests/hostile", "tests/linkage", *(f"tests/{p.name}" for p in (ROOT / "tests").glob("test_*.py"))]
        halves = [room for room in rooms if room not in others], others
        runs = [subprocess.Popen([*command, *half], cwd=ROOT) for half in halves]
        for run in runs:
            run.wait()
        subprocess.run([sys.executable, "-m", "coverage", "combine", f"--rcfile={settings}"], cwd=ROOT, check=True)
    finally:
        settings.unlink()


def faults(file):
    """(line, bytes from and to, new text) for every small change of a source file."""
    raw = file.read_bytes()
    tree = ast.parse(raw)
    starts = [0]
    for line in raw.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for node in ast.walk(tree):
        for (row, column), (last_row, last_column), text in _changes(node):
            begin, end = starts[row - 1] + column, starts[last_row - 1] + last_column
            # Between two operands there may be brackets, which belong to neither.
            if b"(" in raw[begin:end] or b")" in raw[begin:end]:
                continue
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
            yield _end(node.left), _start(node.comparators[0]), f" {COMPARISONS[type(one)]} "
        case ast.BinOp() if type(node.op) in OPERATORS:
            yield _end(node.left), _start(node.right), f" {OPERATORS[type(node.op)]} "
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield _start(node), _start(node.operand), ""
        case ast.BoolOp():
            yield _end(node.values[0]), _start(node.values[1]), " or " if isinstance(node.op, ast.And) else " and "
        case ast.Constant(value=bool()):
            yield _start(node), _end(node), str(not node.value)
        case ast.Constant(value=int() | float()):
            yield _start(node), _end(node), repr(node.value + 1 if isinstance(node.value, int) else node.value * 1.5)
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


def tests_of(file, line):
    """Names of the tests that run a line, those that run few lines first; empty where none does."""
    with sqlite3.connect(MAP) as base:
        rows = base.execute("select id from file where path like ?", (f"%/{file}",)).fetchall()
        found = []
        for (number,) in rows:
            for context, bits in base.execute(
                "select context.context, numbits from line_bits join context on context.id = context_id where file_id = ?",
                (number,),
            ):
                if line // 8 < len(bits) and bits[line // 8] & 1 << line % 8:
                    found.append(context)
    return found


def node_names(contexts):
    """Files and expression that select the tests of these contexts."""
    names, files = set(), set()
    for context in filter(None, contexts):
        module, _, test = context.rpartition(".")
        files.add(module.replace(".", "/") + ".py")
        names.add(test)
    return sorted(f for f in files if (ROOT / f).exists()), sorted(names)


def try_fault(home, file, fault):
    """ "caught", "survived" or "untested"."""
    line, (begin, end), text = fault
    path = Path(home) / file
    original = (ROOT / file).read_bytes()
    contexts = tests_of(file, line)
    files, names = node_names(contexts)
    at_import = not files
    if at_import:  # a line run at import, or by a process of its own only
        files, names = [], []
    path.write_bytes(original[:begin] + text.encode() + original[end:])
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *files]
    if names and len(names) < 400:
        command += ["-k", " or ".join(names)]
    elif at_import:
        room = Path(file).parts[1]
        folder = Path(home) / "tests" / room
        command += [str(folder.relative_to(home)) if folder.is_dir() else "tests/hostile", "tests/test_recipes.py"]
    try:
        done = subprocess.run(command, cwd=home, env=os.environ | {"PYTHONPATH": str(home)}, capture_output=True,
                              text=True, timeout=SECONDS)  # fmt: skip
        if (
            done.returncode == 0 and not at_import
        ):  # the kept drawings and the README, which run in processes of their own
            done = subprocess.run([sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "tests/test_recipes.py"],
                                  cwd=home, env=os.environ | {"PYTHONPATH": str(home)}, capture_output=True, text=True, timeout=SECONDS)  # fmt: skip
            if done.returncode == 1:
                return "caught by the gallery only"
        return {0: "survived", 5: "untested"}.get(done.returncode, "caught")
    except subprocess.TimeoutExpired:
        return "caught (hung)"
    finally:
        path.write_bytes(original)


def shown(file, fault):
    line, (begin, end), text = fault
    raw = (ROOT / file).read_bytes()
    low, high = raw.rfind(b"\n", 0, begin) + 1, raw.find(b"\n", end)
    return f"{file}:{line}\n  - {raw[low:high].decode().strip()}\n  + {(raw[low:begin] + text.encode() + raw[end:high]).decode().strip()}"


def work(jobs):
    with tempfile.TemporaryDirectory() as home:
        skip = shutil.ignore_patterns(".venv", ".git", "__pycache__", ".mypy_cache", ".ruff_cache")
        shutil.copytree(ROOT, home, dirs_exist_ok=True, ignore=skip)
        return [(file, fault, try_fault(home, file, fault)) for file, fault in jobs]


def run(count, seed):
    files = sorted(p.relative_to(ROOT).as_posix() for p in (ROOT / "geomkin").rglob("*.py"))
    every = [(file, fault) for file in files for fault in faults(ROOT / file)]
    by_line = {}
    for file, fault in every:
        by_line.setdefault((file, fault[0]), []).append(fault)
    rng = random.Random(seed)
    chosen = [(file, rng.choice(by_line[file, line])) for file, line in rng.sample(sorted(by_line), count)]
    counts = {}
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        for done in concurrent.futures.as_completed([pool.submit(work, chosen[k::20]) for k in range(20)]):
            for file, fault, verdict in done.result():
                counts[verdict] = counts.get(verdict, 0) + 1
                if verdict != "caught":
                    print(f"{verdict}: {shown(file, fault)}", flush=True)
    print(json.dumps(counts))


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["map"]:
            draw_map()
        case ["run", count, seed]:
            run(int(count), int(seed))
        case ["one", place]:
            file, line = place.split(":")
            for fault in faults(ROOT / file):
                if fault[0] == int(line):
                    print(work([(file, fault)])[0][2], shown(file, fault))
        case _:
            print(__doc__)
