"""Faults: changes of one operator, number, name, sign or condition of the source, as a slip of the hand makes them."""

import ast
import contextlib
import itertools
import random
import re
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
COMPARISONS = {ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">", ast.Eq: "!=", ast.NotEq: "==", ast.In: "not in",
               ast.NotIn: "in", ast.Is: "is not", ast.IsNot: "is"}  # fmt: skip
OPERATORS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.Pow: "*", ast.BitAnd: "|", ast.BitOr: "&",
             ast.FloorDiv: "/", ast.Mod: "*"}  # fmt: skip
NAMES = {"min": "max", "max": "min", "cos": "sin", "sin": "cos", "real": "imag", "imag": "real", "any": "all",
         "all": "any", "minimum": "maximum", "maximum": "minimum", "floor": "ceil", "ceil": "floor",
         "argmin": "argmax", "argmax": "argmin"}  # fmt: skip


def drawn(count, seed, places=("geomkin",)):
    """(file, fault) of random lines of the files whose path begins with one of the places, one a line."""
    files = [path.relative_to(ROOT).as_posix() for path in sorted((ROOT / "geomkin").rglob("*.py"))]
    lines = [(file, line) for file in files if file.startswith(tuple(places))
             for line in sorted({slip[0] for slip in _slips((ROOT / file).read_bytes())})]  # fmt: skip
    rng = random.Random(seed)
    rng.shuffle(lines)
    found = ((file, list(faults(ROOT / file, line))) for file, line in lines)
    return list(itertools.islice(((file, rng.choice(changes)) for file, changes in found if changes), count))


def faults(file, line=None):
    """(line, bytes from and to, new text) for every small change of a source file, or of one line of it."""
    raw = file.read_bytes()
    for row, (begin, end), text in _slips(raw):
        if line in (None, row):
            try:
                ast.parse(raw[:begin] + text.encode() + raw[end:])
            except SyntaxError:
                continue
            yield row, (begin, end), text


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


def shown(file, fault):
    line, (begin, end), text = fault
    raw = (ROOT / file).read_bytes()
    low, high = raw.rfind(b"\n", 0, begin) + 1, raw.find(b"\n", end)
    after = raw[low:begin] + text.encode() + raw[end:high]
    return f"{file}:{line}\n  - {raw[low:high].decode().strip()}\n  + {after.decode().strip()}"


def _slips(raw):
    """The faults of `faults`, and a few changes that are no Python."""
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
