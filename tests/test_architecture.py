"""The plan of the code as tests: who may import whom, and what is loaded for what."""

import ast
import re
import subprocess
import sys
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "geomkin"
FILES = sorted(PACKAGE.rglob("*.py"))

# Folders and modules from the bottom up: each may import those in earlier rows, and nothing beside or above it.
ORDER = (
    ("core",),
    ("plane",),
    ("model",),
    ("export",),
    ("page", "recipe", "making"),
    ("cam", "gear", "belt", "geneva", "cycloidal", "ratchet", "coupon"),
    # A linkage has the gears of its meshes.
    ("linkage",),
    ("synthesis",),
    ("machine",),
    ("build",),
    ("sweeps", "tradeoff", "optimisation", "studio", "verification", "foreign"),
    ("cli",),
    ("face",),
    ("__init__", "__main__"),
)
RANK = {name: k for k, row in enumerate(ORDER) for name in row}
MECHANISMS = {"linkage", "cam", "gear", "belt", "geneva", "cycloidal", "ratchet", "coupon", "synthesis"}
# What the analysis of a mechanism may import, and what its checks, parts and scenes may.
ANALYSIS = {"core", "plane", "model"}
FABRICATION = ANALYSIS | {"export", "making"}
# The only files that may import each heavy library.
ALONE = {
    "shapely": {"plane/region.py"},
    "ezdxf": {"export/dxf.py", "verification/read_back.py"},
    "trimesh": {"export/solids.py", "verification/read_back.py"},
    "click": {"cli/__init__.py", "cli/recipes.py", "cli/show.py", "cli/write.py", "__main__.py"},
    "highspy": {"cam/program/optimise.py"},
    "nlopt": {"optimisation/search.py", "linkage/dynamics/counterweights.py"},
    "mpmath": {"tradeoff/family.py"},
}


def layer(parts):
    """0 for analysis, 1 for checks, parts and scenes, 2 for recipes of a mechanism."""
    inner = parts[1] if len(parts) > 1 else ""
    return 2 if inner == "kinds" else 1 if inner.startswith(("checks", "parts", "scene")) else 0


MODULES = {file.relative_to(PACKAGE).with_suffix("").parts for file in FILES}
MODULES |= {name[:k] for name in MODULES for k in range(1, len(name))}


@cache
def tree(file):
    return ast.parse(file.read_text())


@cache
def nodes(file):
    return list(ast.walk(tree(file)))


def modules_by_text(file):
    """Modules of the package that a file's texts name in full, but for docstrings."""
    docstrings = {node.value for node in nodes(file) if isinstance(node, ast.Expr)}
    texts = [node for node in nodes(file) if isinstance(node, ast.Constant) and node not in docstrings]
    named = [re.match(r"geomkin((?:\.\w+)+)", text.value) for text in texts if isinstance(text.value, str)]
    paths = [PACKAGE.joinpath(*name[1].split(".")[1:]) for name in named if name]
    return [path for path in paths if path.is_dir() or path.with_suffix(".py").exists()]


@cache
def imports(file):
    """Each import of a file, in functions and for type checkers too: ("geomkin", path parts) or (library, ()).

    The table of formats names modules of its own folder by text, as `module:function`; these count too.
    """
    here, found = file.relative_to(PACKAGE).with_suffix("").parts, []
    for node in nodes(file):
        if isinstance(node, ast.Import):
            found += [(name.name.split(".")[0], ()) for name in node.names]
        elif isinstance(node, ast.ImportFrom):
            named = tuple(node.module.split(".")) if node.module else ()
            if not node.level and named[0] != "geomkin":
                found.append((named[0], ()))
                continue
            base = here[: len(here) - node.level] + named if node.level else named[1:]
            for name in node.names:
                module = (*base, name.name)
                found.append(("geomkin", module if module in MODULES else base or ("__init__",)))
        elif isinstance(node, ast.Constant) and (name := re.fullmatch(r"(\w+):\w+", str(node.value))):
            found += [("geomkin", (*here[:-1], name[1]))] * ((*here[:-1], name[1]) in MODULES)
    return tuple(found)


def complaint(here, there):
    """Why a module may not import another; "" if it may."""
    a, b = here[0], there[0]
    if a != b:
        if RANK[b] >= RANK[a]:
            return "upwards or sideways"
        if a in MECHANISMS and layer(here) < 2:
            inner = b in MECHANISMS and layer(there) <= layer(here)
            if not inner and b not in (ANALYSIS, FABRICATION)[layer(here)]:
                return "analysis, parts and scenes know no recipes; analysis knows no making"
    elif a in MECHANISMS and layer(there) > layer(here):
        return "up inside the folder"
    return ""


def test_imports_follow_the_plan():
    wrong = {}
    for file in FILES:
        here = file.relative_to(PACKAGE).with_suffix("").parts
        if here[-1] == "__init__" and len(here) > 1:
            continue  # lists of public names, loaded when first used
        for library, there in imports(file):
            if library == "geomkin" and (why := complaint(here, there)):
                wrong["/".join(here), "/".join(there)] = why
            if library in ALONE and str(file.relative_to(PACKAGE)) not in ALONE[library]:
                wrong["/".join(here), library] = "one file alone imports it"
    assert not wrong


def test_only_the_face_names_modules_by_text():
    assert not {str(file): named for file in FILES if file.name != "face.py" and (named := modules_by_text(file))}
    assert len(modules_by_text(PACKAGE / "face.py")) > 40


def test_no_circle_of_imports():
    modules = {file.relative_to(PACKAGE).with_suffix("").parts: file for file in FILES if file.name != "__init__.py"}
    ahead = {name: {there for _, there in imports(file)} & set(modules) for name, file in modules.items()}
    while free := {name for name, used in ahead.items() if not used & set(ahead)}:
        ahead = {name: used for name, used in ahead.items() if name not in free}
    circle = shortest_circle(ahead)
    assert not circle


def shortest_circle(ahead):
    """One of the shortest ways, in dotted names, from a module of a graph back to itself; "" if there is none."""
    ways = [(name,) for name in ahead]
    for _ in ahead:
        ways = list(
            {(way[0], there): (*way, there) for way in ways for there in sorted(ahead[way[-1]] & ahead.keys())}.values()
        )
        if closed := next((way for way in ways if way[0] == way[-1]), None):
            return " -> ".join(".".join(name) for name in closed)
    return ""


def test_one_shortest_circle_is_shown():
    graph = {"a": "bd", "b": "c", "c": "ad", "d": "e", "e": "da"}
    assert shortest_circle({(name,): {(there,) for there in used} for name, used in graph.items()}) == "d -> e -> d"
    assert not shortest_circle({("a",): {("b",)}, ("b",): set()})


def test_no_module_hides_a_public_name():
    """Importing a module `move` would replace a function `move` of the package that holds it."""
    for stub in PACKAGE.rglob("__init__.pyi"):
        imports_of_stub = [node for node in ast.walk(ast.parse(stub.read_text())) if isinstance(node, ast.ImportFrom)]
        offered = {name.name for node in imports_of_stub if node.module for name in node.names}
        modules = {path.stem for path in stub.parent.iterdir() if path.suffix == ".py" or path.is_dir()}
        assert not offered & modules, stub


def test_no_two_classes_have_one_name():
    names = [node.name for file in FILES for node in tree(file).body if isinstance(node, ast.ClassDef)]
    assert sorted(set(names)) == sorted(names)


@pytest.mark.parametrize("stub", sorted(PACKAGE.rglob("__init__.pyi")), ids=lambda stub: stub.parent.name)
def test_every_public_name_can_be_imported(stub):
    package = import_module(".".join(stub.parent.relative_to(PACKAGE.parent).parts))
    assert package.__all__
    for name in package.__all__:
        assert getattr(package, name) is not None


def loaded_by(code, depth=1):
    """Modules in memory after running code in a fresh interpreter, by the first words of their names."""
    text = f"import sys\n{code}\nprint(*sorted({{'.'.join(m.split('.')[:{depth}]) for m in sys.modules}}))"
    return set(subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True).stdout.split())


HEAVY = {
    "highspy",
    "shapely",
    "trimesh",
    "ezdxf",
    "click",
    "scipy",
    "matplotlib",
    "pandas",
    "nlopt",
}


def test_importing_geomkin_loads_nothing_heavier_than_numpy():
    used = "import geomkin as gk; gk.FourBar; gk.SpurGear(24, 2).outline; gk.flatten(gk.plane.Circle(0, 1), 0.1)"
    assert not loaded_by(used) & HEAVY
    assert "numpy" not in loaded_by("import geomkin")


def test_help_loads_no_numpy():
    code = "from geomkin.cli import cli\ntry: cli(['--help'])\nexcept SystemExit: pass"
    assert "numpy" not in loaded_by(code)


UNLOADED = {"dxf": {"trimesh"}, "csv,stl,page": {"trimesh", "ezdxf"}}


@pytest.mark.parametrize("formats", UNLOADED)
def test_recipe_loads_only_the_libraries_of_its_formats(tmp_path, formats):
    recipe = PACKAGE.parent / "recipes" / "spur-gear.toml"
    code = f"from geomkin.build import make\nmake({str(recipe)!r}, {str(tmp_path)!r}, {formats.split(',')!r})"
    loaded = loaded_by(code, 2)
    assert not {name.split(".")[0] for name in loaded} & (UNLOADED[formats] | {"scipy", "click", "highspy"})
    assert not loaded & {"geomkin.cam", "geomkin.linkage", "geomkin.synthesis"}
