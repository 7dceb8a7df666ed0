"""The page over a folder of made recipes: a card for each, in groups of kinds, searched by words."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import islice
from pathlib import Path
from typing import TypeGuard
from urllib.parse import quote

from ..core.errors import FileError
from ..core.names import file_name_flaw, folded_name
from ..export.formats import tail_of
from ..export.summary import listed_files, read_summary
from ..export.text import text
from .page import colours, head, player_file, script_of
from .sections import picture_address

NAME = "index.html"
# The mark of pages that geomkin wrote, and the number of bytes at the start of a page in which it is searched for.
MARK, MARK_WITHIN = b'<meta name="generator" content="geomkin">', 1000
# Largest picture that is shown, and largest sum of all, bytes. Pictures by geomkin are far smaller; with more the page
# opens slowly.
LARGEST_PICTURE, ALL_PICTURES = 200_000, 5_000_000
# Largest numbers of folders that are searched, of cards, and of files that a card lists. Readers have no use for more.
MOST_FOLDERS, MOST_CARDS, MOST_FILES = 20_000, 2000, 300
# The line that starts the search of the page.
SEARCH = """const wish = document.getElementById("search"), said = document.getElementById("no-match");
wish.addEventListener("input", () => narrow(document, wish.value, ".cards", said));"""
# Heading of kinds that are in no group.
OTHER_KINDS = "other kinds"


def index_page(folder: Path, kinds: Mapping[str, tuple[str, str, str]]) -> dict[str, bytes]:
    """The page for all folders in `folder` that hold the files of a recipe; it loads no other file.

    kinds: of each kind its group, what it is, and other names by which it is found.

    Raises FileError if there are none, or if a page that geomkin did not write has this name.
    """
    _refuse_foreign(folder / NAME)
    cards: dict[str, list[str]] = {group: [] for group in (*(group for group, _, _ in kinds.values()), OTHER_KINDS)}
    count, room = 0, ALL_PICTURES
    for recipe_folder in _folders(folder):
        summary = read_summary(recipe_folder)
        if not summary or not isinstance(recipe := summary.get("recipe"), dict):
            continue
        count += 1
        if count <= MOST_CARDS:
            picture = _picture(recipe_folder, room)
            room -= len(picture)
            kind = kind if isinstance(kind := recipe.get("kind"), str) else ""
            group, about, names = kinds.get(kind, (OTHER_KINDS, "", ""))
            words = f"{recipe_folder.name} {kind} {about} {group} {names}"
            subtitle = f"{kind}: {about}" if about else kind
            cards[group].append(_card(recipe_folder, summary, picture, subtitle, words))
    if not count:
        raise FileError(folder, "no folder in it holds the files of a recipe", "run recipes first", "file-unreadable")
    more = f"<p>And {count - MOST_CARDS:,} more.</p>" if count > MOST_CARDS else ""
    place = folder.resolve().name or "this folder"
    style, script = f"{colours()}{player_file('index.css')}", script_of(("search.js",), SEARCH)
    lists = (
        f'<h2>{text(group)}</h2>\n<ul class="cards">\n{chr(10).join(of)}\n</ul>' for group, of in cards.items() if of
    )
    page = f"""{head(f"Mechanisms in {place}", style, script, MARK.decode())}<body>
<header><h1>Mechanisms</h1><p>{_counted(count, "recipe")} in <bdi>{text(place)}</bdi></p></header>
<main>
<label>Search <input id="search" type="search" placeholder="words or a wish, such as something that dwells"></label>
<p id="no-match" role="status" hidden></p>
{chr(10).join(lists)}
{more}
</main>
<script type="module">{script}</script>
</body>
</html>
"""
    return {NAME: page.encode("utf-8", "replace")}


def _refuse_foreign(path: Path) -> None:
    try:
        if path.is_file():
            with path.open("rb") as file:
                ours = MARK in file.read(MARK_WITHIN)
        else:
            ours = not path.exists()
    except OSError:
        ours = False
    if not ours:
        problem = "it was not written by geomkin, and is left unchanged"
        raise FileError(path, problem, "move it or choose another folder", "file-unwritable")


def _folders(folder: Path) -> list[Path]:
    """The folders in a folder, in alphabetical order."""
    try:
        folders = [path for path in islice(folder.iterdir(), MOST_FOLDERS) if path.is_dir()]
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        raise FileError(folder, problem, "give a folder", "file-unreadable") from error
    valid = [path for path in folders if not file_name_flaw(path.name)]
    return sorted(valid, key=lambda path: (folded_name(path.name), path.name))


def _card(recipe_folder: Path, summary: dict[str, object], picture: str, about: str, words: str) -> str:
    name = recipe_folder.name
    page = f"{name}{tail_of('page')}"
    files = sorted(file for file in listed_files(recipe_folder) if _is_there(recipe_folder / file))
    title = f'<a href="{_link(recipe_folder, page)}">{text(name)}</a>' if page in files else text(name)
    image = f"<img alt=\"{text(name)}, assembled\" src='{picture}'>" if picture else '<div class="none"></div>'
    rows = "".join(f'<li><a href="{_link(recipe_folder, file)}">{text(file)}</a></li>' for file in files[:MOST_FILES])
    more = f"<li>and {len(files) - MOST_FILES:,} more</li>" if len(files) > MOST_FILES else ""
    listed = (
        f"<details><summary>{_counted(len(files), 'file')}</summary><ul>{rows}{more}</ul></details>" if files else ""
    )
    subtitle = f'<p class="kind">{text(about)}</p>' if about else ""
    content = f"{image}<h3><bdi>{title}</bdi></h3>{subtitle}{_verdict(summary.get('checks'))}{listed}"
    return f'<li data-words="{text(words)}">{content}</li>'


def _verdict(checks: object) -> str:
    """Number of checks that pass, and the first one that fails."""
    if not isinstance(checks, list) or not checks or not all(map(_is_check, checks)):
        return ""
    failing = [check for check in checks if _is_check(check) and not check["passed"]]
    failing.sort(key=lambda check: "expected" in check)
    failed = [check["name"] for check in failing]
    if not failed:
        verdict = "The only check passed." if len(checks) == 1 else f"All {len(checks):,} checks passed."
        return f'<p class="holds">{verdict}</p>'
    fails, is_expected = "fails" if len(failed) == 1 else "fail", all("expected" in check for check in failing)
    fails += " as expected" * is_expected
    verdict = f"{len(failed):,} of {_counted(len(checks), 'check')} {fails}: {text(str(failed[0])[:200])}"
    return (
        f'<p class="{"expected" if is_expected else "fails"}">{verdict}{" and others" if len(failed) > 1 else ""}.</p>'
    )


def _is_check(check: object) -> TypeGuard[dict[str, object]]:
    return isinstance(check, dict) and isinstance(check.get("passed"), bool) and isinstance(check.get("name"), str)


def _picture(recipe_folder: Path, room: int) -> str:
    """The picture of the assembly as a data address. Shown as an image, it can neither run nor load anything."""
    path = recipe_folder / f"{recipe_folder.name}{tail_of('assembly-svg')}"
    try:
        if not path.is_file() or path.stat().st_size > LARGEST_PICTURE:
            return ""
        with path.open("rb") as file:
            content = file.read(LARGEST_PICTURE + 1)
    except OSError:
        return ""
    # An image shows no titles.
    address = picture_address(re.sub(rb"<title>[^<]*</title>", b"", content))
    return address if len(content) <= LARGEST_PICTURE and len(address) <= room else ""


def _is_there(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:
        return False


def _link(recipe_folder: Path, file: str) -> str:
    """Address of a file relative to the page, with special characters escaped."""
    return f"./{quote(recipe_folder.name)}/{quote(file)}"


def _counted(count: int, word: str) -> str:
    return f"{count:,} {word}{'' if count == 1 else 's'}"
