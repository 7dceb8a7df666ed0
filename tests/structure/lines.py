"""How much code the package has, next to the aims: python tests/structure/lines.py.

A line of code is one with a token that is neither a comment nor part of a docstring. Members of a class are the methods and
properties in its own body. A function has the lines of code between its first and its last, those of inner functions too.
"""

import ast
import io
import sys
import tokenize
from dataclasses import dataclass
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "geomkin"
# Largest numbers that the package should have.
MOST_LINES, MOST_FILES, MOST_MEMBERS, MOST_FUNCTION_LINES = 51_000, 260, 25, 60
# Rows of the largest classes and functions that are shown, at least; all above an aim are counted.
SHOWN = 8
SPACE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass(frozen=True)
class FileLines:
    """The lines of code and of docstrings of a file, and the sizes of its classes and functions by name."""

    code: int
    docstrings: int
    members: dict[str, int]
    functions: dict[str, int]


def measured(text: str) -> FileLines:
    """The lines of a file with this text."""
    tree = ast.parse(text)
    docstrings = docstring_lines(tree)
    code = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in SPACE:
            code |= set(range(token.start[0], token.end[0] + 1))
    code -= docstrings
    members, functions = {}, {}

    def visit(node: ast.AST, prefix: str) -> None:
        for child in ast.iter_child_nodes(node):
            name = f"{prefix}{getattr(child, 'name', '')}"
            if isinstance(child, ast.ClassDef):
                members[name] = len({item.name for item in child.body if isinstance(item, FUNCTIONS)})
            elif isinstance(child, FUNCTIONS):
                functions[name] = len(code & set(range(child.lineno, child.end_lineno + 1)))
            named = isinstance(child, (ast.ClassDef, *FUNCTIONS))
            visit(child, f"{name}." if named else prefix)

    visit(tree, "")
    return FileLines(len(code), len(docstrings), members, functions)


def docstring_lines(tree: ast.Module) -> set[int]:
    """Numbers of the lines of all docstrings, those below fields too."""
    texts = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    ]
    return {line for node in texts for line in range(node.lineno, node.end_lineno + 1)}


def table(package: Path) -> str:
    """The figures of a package as text."""
    files = {path.relative_to(package.parent): measured(path.read_text("utf-8")) for path in package.rglob("*.py")}
    folders: dict[str, list[int]] = {}
    for path, file in files.items():
        count = folders.setdefault(path.parts[1] if len(path.parts) > 2 else "face", [0, 0])
        count[0] += file.code
        count[1] += 1
    members = {f"{name} ({path})": count for path, file in files.items() for name, count in file.members.items()}
    functions = {f"{name} ({path})": count for path, file in files.items() for name, count in file.functions.items()}
    code = sum(file.code for file in files.values())
    rows = [
        ("lines of code", code, MOST_LINES),
        ("files", len(files), MOST_FILES),
        ("members of the largest class", max(members.values(), default=0), MOST_MEMBERS),
        ("lines of the longest function", max(functions.values(), default=0), MOST_FUNCTION_LINES),
    ]
    lines = [f"{'':32}{'now':>8}{'aim':>8}"]
    lines += [f"{name:32}{now:8,}{aim:8,}{'' if now <= aim else '  above'}" for name, now, aim in rows]
    lines += [f"{'lines of docstrings':32}{sum(file.docstrings for file in files.values()):8,}", "", "folders"]
    lines += [f"{count:8,}{n:6,} files  {name}" for name, (count, n) in sorted(folders.items(), key=lambda f: -f[1][0])]
    for title, counts, most in (
        ("members of classes", members, MOST_MEMBERS),
        ("lines of functions", functions, MOST_FUNCTION_LINES),
    ):
        largest = sorted(counts.items(), key=lambda item: (-item[1], item[0]))
        lines += ["", f"{title}: {sum(count > most for count in counts.values())} above {most}"]
        lines += [f"{count:8,}  {name}" for name, count in largest[:SHOWN]]
    return "\n".join(lines)


if __name__ == "__main__":
    print(table(Path(sys.argv[1]) if sys.argv[1:] else PACKAGE))
