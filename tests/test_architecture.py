"""The house plan as tests: who may import whom, what loads what, how long a file may be, what may be written how."""

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "geomkin"
FILES = sorted(PACKAGE.rglob("*.py"))
CACHED = PACKAGE / "cached.py"

# Words that every room may use.
WORDS = {
    "arguments",
    "brief",
    "cached",
    "display",
    "errors",
    "names",
    "sizes",
    "lazy",
    "__init__",  # the version
    "progress",
    "beside",
    "processes",
    "scaling",
}
GEOMETRY = {"plane", "table"}
MECHANISMS = {"linkage", "cam", "gear"}
# Each room and the rooms it may look into besides.
MAY = {
    **{word: set() for word in WORDS},
    "check": set(),
    "table": {"plane"},
    "plane": set(),
    "part": {"plane"},
    "scene": {"plane", "part", "table"},
    "walls": {"plane", "part", "check"},
    **dict.fromkeys(MECHANISMS, GEOMETRY),
    "web": set(),
    "export": {"plane", "part", "table", "check", "scene", "web"},
    "synthesis": MECHANISMS | GEOMETRY,
    "judge": MECHANISMS | GEOMETRY | {"synthesis", "check"},
    "scenes": MECHANISMS | GEOMETRY | {"synthesis", "part", "scene"},
    "shop": MECHANISMS | GEOMETRY | {"synthesis", "part"},
    # Text only: it knows no mechanism, and of formats their names.
    "recipe": GEOMETRY | {"scene", "part", "check", "walls", "export"},
    "kinds": MECHANISMS | GEOMETRY | {"synthesis", "scene", "scenes", "part", "check", "judge", "shop", "recipe"},
    # Whatever has methods to compare, but no recipe's kind.
    "tradeoff": MECHANISMS | GEOMETRY | {"synthesis", "part", "shop", "export"},
    "build": {"scene", "part", "table", "check", "export", "recipe", "kinds"},
    "sweeps": {"build", "plane", "table", "check", "export", "recipe", "kinds"},
    # All that can be shown, and what shows it.
    "notebook": MECHANISMS
    | GEOMETRY
    | {"synthesis", "scene", "scenes", "part", "check", "judge", "shop", "recipe", "kinds", "export", "build"},
    "commands": {"build", "sweeps", "recipe", "kinds", "export", "tradeoff"},
    "__init__": {
        "build",
        "sweeps",
        "notebook",
        "kinds",
        "part",
        "check",
        "export",
        "judge",
        "shop",
        "recipe",
        "scenes",
        "synthesis",
        "tradeoff",
    }
    | MECHANISMS
    | GEOMETRY,
    "__main__": {"commands"},
}
# The only files that may load each heavy library.
ALONE = {
    "shapely": {"plane/region.py"},
    "ezdxf": {"export/dxf.py"},
    "trimesh": {"export/glb.py"},
    "pydantic": {"recipe/load.py", "recipe/explain.py", "recipe/template.py", "recipe/settings.py", "sizes.py"},
    "pydantic_core": {
        "sizes.py",
        "cam/program/program.py",
        "recipe/settings.py",
        "kinds/path_files.py",
        "kinds/any_linkage.py",
    },
    "click": {"commands.py", "__main__.py"},
    "numba": {"linkage/solve/compiled.py"},
    "highspy": {"cam/program/least_peak.py"},
    "mpmath": {"tradeoff/cell.py"},
}


@cache
def nodes(file):
    """All that a file's text is made of."""
    return tuple(ast.walk(ast.parse(file.read_text())))


def imports(file):
    """(top-level library) or (room of geomkin) for every import of a file, wherever it stands."""
    here = file.relative_to(PACKAGE).parts
    for node in nodes(file):
        if isinstance(node, ast.Import):
            yield from (("library", name.name.split(".")[0]) for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield "library", (node.module or "").split(".")[0]
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level]
            if node.module:
                yield "room", (*base, *node.module.split("."))[0]
            else:
                yield from (
                    ("room", (*base, n.name if not n.name.startswith("_") else "__init__")[0]) for n in node.names
                )


@pytest.mark.parametrize("file", FILES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_imports_point_one_way(file):
    room = file.relative_to(PACKAGE).parts[0].removesuffix(".py")
    allowed = MAY[room] | {room} | WORDS
    found = set(imports(file))
    used = {name for what, name in found if what == "room"}
    assert used <= allowed, f"{room} must not import {used - allowed}"
    for library, homes in ALONE.items():
        if ("library", library) in found:
            assert str(file.relative_to(PACKAGE)) in homes


@pytest.mark.parametrize("file", FILES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_no_file_outgrows_a_reader(file):
    assert len(file.read_text().splitlines()) <= 500
    assert not {"utils", "helpers", "misc", "extended", "common"} & set(file.stem.split("_"))


MODULES = {".".join(file.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__"): file for file in FILES}
# Rooms' lists of names, which load nothing by themselves.
LISTS = {
    name for name, file in MODULES.items() if "attach(__name__)" in file.read_text() and file.name == "__init__.py"
}


def modules_in(file):
    """Modules of geomkin that a file imports, wherever it does: in functions and for type checkers, too."""
    here = file.relative_to(PACKAGE).parts
    for node in nodes(file):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = [*here[: len(here) - node.level], *(node.module or "").split(".")]
            for name in node.names:
                module = ".".join(part for part in (*base, name.name) if part)
                yield module if module in MODULES else ".".join(part for part in base if part) or "__init__"


def test_no_property_locks_a_whole_class():
    # That of functools does, before Python 3.12.
    for file in FILES:
        if file != CACHED:
            taken = [n for n in nodes(file) if isinstance(n, ast.ImportFrom) and n.module == "functools"]
            assert all(name.name != "cached_property" for n in taken for name in n.names), file


def test_no_circle_of_imports():
    ahead = {name: set(modules_in(file)) for name, file in MODULES.items() if name not in LISTS}
    # What imports nothing that is left, and what nothing that is left imports, stands in no circle.
    while free := {n for n in ahead if not ahead[n] & set(ahead) or not any(n in used for used in ahead.values())}:
        ahead = {name: used for name, used in ahead.items() if name not in free}
    assert not ahead, ahead


def calls(within, attribute):
    """Calls of a method among nodes, as `thing.attribute(...)`, and what they are called on."""
    for node in within:
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == attribute:
            yield node.func.value


@pytest.mark.parametrize("file", [f for f in FILES if f != CACHED], ids=lambda f: str(f.relative_to(PACKAGE)))
def test_what_is_frozen_stays_so(file):
    """But for properties that are kept: no writing into `__dict__`, no thing made past its own class; fields are settled while a thing is made."""
    held = [node for node in nodes(file) if isinstance(node, ast.Attribute) and node.attr == "__dict__"]
    read = {id(node) for node in nodes(file) if isinstance(node, ast.Tuple) for node in node.elts}
    read |= {id(value) for what in ("get", "items") for value in calls(nodes(file), what)}
    written = [node.lineno for node in held if id(node) not in read]
    made = [value.id for value in calls(nodes(file), "__new__") if isinstance(value, ast.Name)]
    functions = [node for node in nodes(file) if isinstance(node, ast.FunctionDef)]
    settled = [function.name for function in functions for _ in calls(ast.walk(function), "__setattr__")]
    assert not written and not made
    assert all(name in ("__post_init__", "called") or name.lstrip("_").startswith("settle") for name in settled), (
        settled
    )


@pytest.mark.parametrize("file", FILES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_a_recipe_is_never_of_any_type(file):
    arguments = [node for node in nodes(file) if isinstance(node, ast.arg) and node.arg == "recipe"]
    assert all(node.annotation and ast.unparse(node.annotation) != "Any" for node in arguments)
    if file.parent.name == "kinds":
        fields = [field for node in nodes(file) if isinstance(node, ast.ClassDef) for field in node.body]
        hints = [ast.unparse(field.annotation) for field in fields if isinstance(field, ast.AnnAssign)]
        assert "Any" not in hints


def test_formats_and_kinds_are_listed_once():
    from geomkin.export import WRITERS
    from geomkin.kinds import KINDS

    for names, home in ((WRITERS, "export/writers.py"), (KINDS, "kinds/__init__.py")):
        for file in FILES:
            for node in nodes(file):
                rows = node.keys if isinstance(node, ast.Dict) else getattr(node, "elts", [])
                listed = {row.value for row in rows if isinstance(row, ast.Constant)} & set(names)
                assert len(listed) < 2 or file == PACKAGE / home, (file, listed)


def loaded_by(code, depth=1):
    """Modules in memory after running code in a fresh interpreter, by the first words of their names."""
    text = f"import sys\n{code}\nprint(*sorted({{'.'.join(m.split('.')[:{depth}]) for m in sys.modules}}))"
    return set(subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True).stdout.split())


HEAVY = {
    "highspy",
    "shapely",
    "trimesh",
    "ezdxf",
    "pydantic",
    "click",
    "scipy",
    "matplotlib",
    "numba",
    "pandas",
    "networkx",
}


def test_importing_geomkin_loads_nothing_heavier_than_numpy():
    used = "import geomkin as gk; gk.FourBar; gk.SpurGear(24, 2).outline; gk.flatten(gk.plane.Circle(0, 1), 0.1)"
    assert not loaded_by(used) & HEAVY
    assert "numpy" not in loaded_by("import geomkin")


def test_help_loads_no_numpy():
    code = "from geomkin.commands import cli\ntry: cli(['--help'])\nexcept SystemExit: pass"
    assert "numpy" not in loaded_by(code)


def test_a_gear_alone_loads_no_mates():
    mates = {f"geomkin.gear.{name}" for name in ("conjugate", "pair", "planetary", "rack")}
    assert not loaded_by("import geomkin.kinds.single_gears", 3) & mates
    assert loaded_by("import geomkin.kinds.planetary, geomkin.kinds.conjugate_gears", 3) >= mates


UNLOADED = {
    "dxf": {"trimesh"},
    "csv": {"trimesh", "ezdxf"},
    "stl": {"ezdxf", "trimesh"},
    "svg": {"ezdxf", "trimesh"},
    "page": {"ezdxf", "trimesh"},
    "check": {"ezdxf", "trimesh"},
}
# Of no use to any format.
NEVER = {"matplotlib", "scipy", "numba", "pandas", "networkx", "click", "mpmath"}
RECIPES = sorted((PACKAGE.parent / "recipes").glob("*.toml"))


def loaded_for(formats, recipes, out):
    """Modules in memory after the recipes are made or checked in one process; the linear programs' only if asked for."""
    done = "check_recipe(file)" if formats == "check" else f"make(file, {str(out)!r}, [{formats!r}])"
    files = [str(recipe) for recipe in recipes]
    return loaded_by(f"from geomkin.build import check_recipe, make\nfor file in {files}: {done}")


@pytest.mark.parametrize("formats", UNLOADED)
def test_a_recipe_loads_only_what_it_writes(tmp_path, formats):
    some = [file for file in RECIPES if file.stem in ("spur-gear", "slider-crank", "inflection-circle")]
    assert not loaded_for(formats, some, tmp_path) & (UNLOADED[formats] | NEVER | {"highspy"})
    stem = "gear.stl" if formats == "stl" else "spur-gear." + {"page": "html"}.get(formats, formats)
    assert (tmp_path / "spur-gear" / stem).exists() == (formats != "check")


def test_a_gear_loads_no_other_mechanism(tmp_path):
    gear = PACKAGE.parent / "recipes" / "spur-gear.toml"
    code = f"from geomkin.build import make\nmake({str(gear)!r}, {str(tmp_path)!r})"
    loaded = loaded_by(code, 2)
    assert not loaded & {"geomkin.cam", "geomkin.linkage", "geomkin.synthesis"}
    # Each takes longer to load than a gear asks of it.
    assert not loaded & {"numpy.ma", "numpy.polynomial"}


def test_words_for_what_is_wrong_are_loaded_where_something_is(tmp_path):
    right, wrong = PACKAGE.parent / "recipes" / "spur-gear.toml", tmp_path / "wrong.toml"
    wrong.write_text("kind = 'spur-gea'")
    words, code = (
        "geomkin.recipe.explain",
        "import contextlib, geomkin as gk\nwith contextlib.suppress(gk.RecipeError):",
    )
    assert words not in loaded_by(f"{code} gk.load({str(right)!r})", 3)
    assert words in loaded_by(f"{code} gk.load({str(wrong)!r})", 3)


@pytest.mark.campaign
@pytest.mark.parametrize("formats", UNLOADED)
def test_all_recipes_load_only_what_they_write(tmp_path, formats):
    assert not loaded_for(formats, RECIPES, tmp_path) & (UNLOADED[formats] | NEVER)


ROOMS = [
    "cam",
    "export",
    "gear",
    "judge",
    "kinds",
    "linkage",
    "plane",
    "recipe",
    "shop",
    "scenes",
    "synthesis",
    "tradeoff",
]


def test_every_public_name_is_there_and_documented():
    import geomkin

    for name in dir(geomkin):
        assert name.startswith("_") or getattr(geomkin, name).__doc__, name
    for room in ROOMS:
        folder = getattr(geomkin, room)
        # A module would stand in the way of what has its name.
        modules = {file.stem for file in (PACKAGE / room).iterdir()}
        for name in (name for name in set(dir(folder)) - modules if not name.startswith("_")):
            thing = getattr(folder, name)
            assert not getattr(thing, "__module__", "").startswith("geomkin") or thing.__doc__, name


@pytest.mark.parametrize("room", ["", *(f"{room}/" for room in ROOMS)])
def test_no_name_that_is_offered_is_a_files_name_too(room):
    offered = {
        name.name
        for node in ast.walk(ast.parse((PACKAGE / room / "__init__.py").read_text()))
        if isinstance(node, ast.ImportFrom) and node.module
        for name in node.names
    }
    assert not offered & {file.stem for file in (PACKAGE / room).iterdir()}
