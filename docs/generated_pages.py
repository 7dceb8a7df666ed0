"""The pages of the site that are made from the package: gallery, keys, checks, terms, commands, examples in
print and the Python names."""

import json
import shutil
from pathlib import Path

from published import published_pages

import geomkin as gk
from geomkin.core.fields import clipped
from geomkin.model.explanations import CHECKS, REFUSALS, TERMS
from geomkin.recipe.kinds import all_kinds, gallery, recipe_class
from geomkin.recipe.template import schema

HEADINGS = {"linkages": "Linkages", "synthesis": "Linkages found for a wanted motion"}
# Pictures of a recipe in `out/`, the first that exists.
PICTURES = ("animation", "assembly", "")


def write_pages(docs: Path, site: Path) -> None:
    """Write all pages into `docs/generated`, and copy the moving pages of the gallery into the site."""
    folder = docs / "generated"
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("keys", "published"):
        (folder / name).mkdir(parents=True)
    moving = copy_moving_pages(docs.parent / "out", site)
    (folder / "static").mkdir()
    (folder / "static" / "moving.js").write_text(f"const MOVING = {json.dumps(moving)};\n", "utf-8")
    for name, text in {**pages(docs.parent, moving), **key_pages(), **published_pages()}.items():
        (folder / name).write_text(text, "utf-8")


def copy_moving_pages(out: Path, site: Path) -> list[str]:
    """Copy the moving pages of the gallery that were made into the site; return the names of their recipes."""
    (site / "moving").mkdir(parents=True, exist_ok=True)
    made = [page for page in sorted(out.glob("*/*.html")) if page.stem == page.parent.name]
    for page in made:
        shutil.copy(page, site / "moving")
    return [page.stem for page in made]


def pages(root: Path, moving: list[str]) -> dict[str, str]:
    """The pages by name, without those of keys."""
    return {
        "gallery.md": gallery_page(root, moving),
        "checks.md": checks_page(),
        "glossary.md": "# Glossary: what the terms mean\n\n"
        + "\n".join(
            f"## {term}\n\n{text}\n" for term, text in sorted(TERMS.items(), key=lambda row: row[0].casefold())
        ),
        "commands.md": "# Commands\n\n```{eval-rst}\n.. click:: geomkin.cli:cli\n   :prog: geomkin\n   :nested: full\n```\n",
        "python.md": python_page(),
    }


def gallery_page(root: Path, moving: list[str]) -> str:
    """A card for each recipe of the gallery, by group, with its picture and, if it was made, its moving page."""
    _, recipes = gallery()
    groups: dict[str, list[str]] = {}
    for file, (kind, about) in recipes.items():
        name = Path(file).stem
        pictures = [root / "out" / name / f"{name}{f'-{end}' if end else ''}.svg" for end in PICTURES]
        picture = next((one for one in pictures if one.is_file()), None)
        lines = [f":::{{grid-item-card}} {name}", f":link: ../moving/{name}.html" if name in moving else "", ""]
        if picture:
            lines += [f'<img src="../../out/{name}/{picture.name}" alt="{name}" class="card-picture">', ""]
        lines += [f"{about}.", "", f"[`{kind}`](keys/{kind}.md)", ":::"]
        groups.setdefault(all_kinds()[kind].group, []).append("\n".join(lines))
    text = "# Gallery: every recipe\n\nA card opens its moving page, if `geomkin run recipes` was run before the site was built.\n"
    for group, cards in groups.items():
        text += f"\n## {HEADINGS.get(group, group.capitalize())}\n\n::::{{grid}} 1 2 3 4\n:gutter: 2\n\n"
        text += "\n\n".join(cards) + "\n\n::::\n"
    return text


def checks_page() -> str:
    """What each check compares, where its limit comes from, and what to change."""
    text = (
        "# Checks: what they mean, limits, remedies\n\n"
        "`geomkin explain ID` prints the same. The id in `summary.json` may have the name of a part before or behind "
        "the id given here: `stage_1_contact_ratio`, `wall_rocker`.\n"
    )
    for id, entry in CHECKS.items():
        text += f"\n({id})=\n## {entry['name']}\n\n`{id}`: {entry['meaning']}\n\n"
        text += f"- Limit: {entry['limit']}\n- Remedy: {entry['remedy']}\n"
    text += "\n## Refusals: why a recipe is not made\n\nThe id is in the JSON of `--json`, and in `error.problems` in Python.\n"
    return text + "".join(f"\n### {id}\n\n{about}\n" for id, about in REFUSALS.items())


def python_page() -> str:
    """The names of `import geomkin as gk`, each with a page of its own."""
    names = [name for name in gk.__all__ if not hasattr(getattr(gk, name), "__path__")]
    rows = "\n".join(f"   geomkin.{name}" for name in names)
    return f"# Python\n\n```{{eval-rst}}\n.. autosummary::\n   :toctree: python\n   :nosignatures:\n\n{rows}\n```\n"


def key_pages() -> dict[str, str]:
    """A page of the keys of each kind, one of the tables that several kinds share, and an index."""
    tables = schema()["$defs"]
    kinds = {name: recipe_class(name) for name in all_kinds() if recipe_class(name).__module__.startswith("geomkin.")}
    used = {name: _reached(tables, kind.__name__) for name, kind in kinds.items()}
    shared = {table for table in tables if sum(table in reached for reached in used.values()) > 1}
    written = {}
    for name, kind in kinds.items():
        own = [table for table in used[name] if table not in shared]
        heads = _tables_text(tables, [table for table in own if table != kind.__name__])
        about = tables[kind.__name__]["description"]
        top = _rows(tables, kind.__name__)
        written[f"keys/{name}.md"] = f"# Keys of {name}\n\n{about}\n\n{top}\n{heads}"
    text = "# Tables that several kinds share\n"
    written["keys/shared.md"] = text + _tables_text(tables, sorted(shared))
    listed = "\n".join(
        f"- [`{name}`]({name}.md): {tables[kind.__name__]['description'].splitlines()[0]}"
        for name, kind in kinds.items()
    )
    tree = "\n".join(["shared", *kinds])
    written["keys/index.md"] = (
        f"# Keys of each kind of recipe\n\n{listed}\n- [Shared tables](shared.md)\n\n```{{toctree}}\n:hidden:\n{tree}\n```\n"
    )
    return written


def _reached(tables, start: str) -> list[str]:
    """Tables that a table holds, itself first."""
    found, todo = [], [start]
    while todo:
        name = todo.pop(0)
        if name not in found:
            found.append(name)
            todo += _references(tables[name])
    return found


def _references(node) -> list[str]:
    if isinstance(node, dict):
        own = [node["$ref"].rpartition("/")[2]] if node.get("$ref", "#") != "#" else []
        return own + [name for value in node.values() for name in _references(value)]
    return [name for item in node for name in _references(item)] if isinstance(node, list) else []


def _tables_text(tables, names) -> str:
    return "".join(
        f"\n(table-{name.lower()})=\n## {name}\n\n{_first(tables[name])}\n\n{_rows(tables, name)}"
        for name in names
    )


def _first(table) -> str:
    return table["description"].split("\n\n")[0].replace("\n", " ")


def _rows(tables, name: str) -> str:
    """A Markdown table of the keys of a table."""
    rows = ["| key | default | meaning |", "|---|---|---|"]
    required = tables[name]["required"]
    for key, field in tables[name]["properties"].items():
        default = "required" if key in required else json.dumps(field["default"]) if "default" in field else ""
        links = ", ".join(f"[{table}](#table-{table.lower()})" for table in dict.fromkeys(_references(field)))
        limits = [f"{word} {field[key]:g}" for word, key in LIMITS.items() if key in field]
        if "enum" in field:
            limits.append("one of " + ", ".join(f"`{one}`" for one in field["enum"]))
        meaning = "; ".join(filter(None, [field.get("description", ""), *limits, links])).replace("|", "\\|")
        rows.append(f"| `{key}` | {f'`{clipped(default)}`' if default else ''} | {meaning} |")
    return "\n".join(rows) + "\n"


LIMITS = {"above": "exclusiveMinimum", "at least": "minimum", "below": "exclusiveMaximum", "at most": "maximum"}
