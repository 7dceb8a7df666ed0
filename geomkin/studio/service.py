"""What the studio answers to the requests of its page: from plain values to plain values, without HTTP."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, partial
from http import HTTPStatus
from io import BytesIO
from itertools import takewhile
from textwrap import shorten
from threading import Event, Lock
from typing import Any
from urllib.parse import quote
from zipfile import ZIP_DEFLATED, ZipFile

from ..build import make
from ..core.errors import DesignError, GeomkinError, printable
from ..core.names import file_name_flaw
from ..export.job import Job
from ..export.scene_svg import animation, assembly_picture
from ..recipe.kinds import KINDS, all_kinds, gallery, recipe_class
from ..recipe.load import parse
from ..recipe.recipe import AbstractGoal, AbstractRecipe
from ..recipe.search import other_names
from ..recipe.shown import ShownRecipe
from ..recipe.template import template
from .building import EMPTY
from .drafts import Draft, read
from .edit import answer, problems_of
from .form import recipe_form
from .strokes import known_linkages
from .workspace import BackgroundJob, Jobs, Workspace

# Characters of the description of a recipe in the gallery.
LONGEST_TITLE = 240
# Characters of a recipe that are searched.
LONGEST_SEARCHED = 8000
# Seconds that an answer may take before it goes on as a job.
AT_ONCE = 0.4
# Seconds for which a request for changes of a file waits, and between two looks at it.
LONGEST_WAIT, LOOK = 25.0, 0.3
# Types of the optional parts of a request for an answer.
REQUEST: dict[str, type] = {
    "set": dict,
    "drag": dict,
    "build": dict,
    "draw": dict,
    "add": str,
    "locks": list,
    "lane": str,
}
# Seconds for which a server that is closed waits for jobs, and for requests: enough to write a recipe. A longer
# computation is given up.
LAST_WAIT = 1.0
# Recipes whose results are kept: before and after a change.
KEPT = 3


class RefusedError(Exception):
    """A request that is answered by a status and a reason."""

    def __init__(self, status: HTTPStatus, problem: str, remedy: str = ""):
        super().__init__(problem)
        self.status, self.problem, self.remedy = status, problem, remedy


class Studio:
    """What the server answers, without HTTP: one method for each request, from a mapping to data for JSON.

    Parameters
    ----------
    workspace : Workspace
        The folder.
    first : str
        Name of the recipe that is opened first; "" for the gallery.
    kept : Draft, optional
        The recipe of a notebook: `kept` follows what is edited, and a page that is loaded again shows it again.
    """

    def __init__(self, workspace: Workspace, first: str = "", kept: Draft | None = None):
        self.workspace, self.first, self.kept, self.jobs = workspace, first, kept, Jobs()
        self._lock, self._closed = Lock(), Event()
        # The last recipes, whose checks are asked for after their scenes.
        self._last: list[Draft] = []
        # The last search for checks, and the last one for a scene.
        self._searches: dict[bool, BackgroundJob] = {}
        self._pictures: dict[tuple[str, bool], bytes] = {}
        # The recipe of each folder of files that was made, and those that it names.
        self._sources: dict[str, dict[str, str]] = {}

    def get(self, name: str, query: Mapping[str, str]) -> Any:
        """The answer to a GET request."""
        match name:
            case "start":
                first, text = (self.kept.name, self.kept.text) if self.kept else (self.first, "")
                return {"first": first, "text": text, "folder": str(self.workspace.folder)}
            case "gallery":
                kinds = [
                    {
                        "kind": kind,
                        "group": row.group,
                        "about": recipe_class(kind).about(),
                        "words": other_names(kind),
                        "joins": _joins(kind),
                    }
                    for kind, row in all_kinds().items()
                ]
                return {"kinds": kinds, "recipes": [self._listed(name) for name in self.workspace.recipes]}
            case "examples":
                return {"examples": self._examples}
            case "picture":
                return self._picture(query)
            case "job":
                return self._job(query).state
            case "changed":
                return self._changed(query)
        raise RefusedError(HTTPStatus.NOT_FOUND, "there is no such page")

    def post(self, name: str, body: Mapping[str, Any]) -> Any:
        """The answer to a POST request."""
        match name:
            case "answer":
                return self._answer(body)
            case "form":
                values = body.get("values")
                known = {
                    key: value
                    for key, value in (values.items() if isinstance(values, dict) else ())
                    if isinstance(value, str) or not (key == "units" or key.endswith(".kind"))
                }
                return self._known_kind(body, partial(recipe_form, values=known))
            case "open":
                opened = self.workspace.open(_text(body, "recipe"))
                return {"recipe": body["recipe"], "text": opened.text, "base": opened.base}
            case "save":
                name = _text(body, "recipe")
                return {"recipe": name, "base": self.workspace.save(name, _text(body, "text"), _text(body, "base"))}
            case "new":
                options = body.get("options") or []
                if not isinstance(options, list) or not all(isinstance(option, str) for option in options):
                    raise RefusedError(HTTPStatus.BAD_REQUEST, "options has the wrong form", "give a list of texts")
                if body.get("kind") == "":
                    return {"text": EMPTY}
                if "example" in body:
                    return {"text": Workspace(gallery()[0]).open(_text(body, "example")).text}
                return {"text": self._known_kind(body, lambda kind: template(recipe_class(kind), options))}
            case "nearest":
                return {"known": known_linkages(body.get("points"))}
            case "make":
                id, _ = self.jobs.start(partial(self._made, _text(body, "text"), _text(body, "recipe")))
                return {"job": id}
            case "stop":
                self._job(body).stop()
                return {}
        raise RefusedError(HTTPStatus.NOT_FOUND, "there is no such page")

    def close(self) -> None:
        """End all jobs, and requests that wait for a change of a file."""
        self._closed.set()
        self.jobs.stop_all(LAST_WAIT)

    def _answer(self, body: Mapping[str, Any]) -> Any:
        """An answer at once, or the job of a search that takes longer; a new request ends the searches before it.

        A request for checks ends no search for a scene: it may arrive late, and the scene is the answer to an edit.
        """
        text, name = _text(body, "text"), _text({"recipe": "", **body}, "recipe")
        for key, form in REQUEST.items():
            if not isinstance(body.get(key) or form(), form):
                raise RefusedError(HTTPStatus.BAD_REQUEST, f"{key} has the wrong form", "give what the docs state")
        if not all(isinstance(key, str) for key in body.get("locks") or ()):
            raise RefusedError(HTTPStatus.BAD_REQUEST, "locks has the wrong form", "give keys")
        # The file of a mechanism that is joined.
        further = [f"{(body.get('join') or {}).get('recipe')}.toml"]
        work = partial(self._answered, text, self.workspace.files_of(text, further), _with_source(body), name)
        if not (_is_search(text) or body.get("draw")):
            return work()
        is_check = body.get("lane") == "checks"
        with self._lock:
            for of_check, search in self._searches.items():
                if of_check or not is_check:
                    search.stop()
            id, job = self.jobs.start(work)
            self._searches[is_check] = job
        job.done.wait(AT_ONCE)
        return job.result if job.result is not None else {"job": id}

    def _answered(self, text: str, files: dict[str, str], request: dict[str, Any], name: str) -> dict[str, Any]:
        try:
            reply = answer(text, files, request, name, self._read)
            if self.kept and request.get("lane") != "checks":
                self.kept = Draft(reply["text"], files, name)
            return reply
        except Exception as error:
            # A fault of ours must not lose the user's text.
            problem = f"internal error ({printable(f'{type(error).__name__}: {error}', 200)})"
            entry = {"key": "", "problem": problem, "remedy": "please report it", "id": "internal"}
            return {**answer("", {}, {}), "text": text, "problems": [entry]}

    def _read(self, draft: Draft) -> AbstractRecipe:
        """The recipe of a draft; the last ones are kept, for every request of a drag starts from the same text."""
        last = next((last for last in self._last if (last.text, last.files) == (draft.text, draft.files)), None)
        # Saved under a name: what was found stays.
        recipe = read(draft) if last is None else last.recipe.with_name(draft.name)
        known = replace(draft, reader=lambda _: recipe)
        self._last = [known, *(other for other in self._last if other is not last)][:KEPT]
        return recipe

    def _made(self, text: str, name: str) -> dict[str, Any]:
        try:
            recipe = parse(text, name, str(self.workspace.folder)).with_name(name)
            made = make(recipe, self.workspace.folder / "out")
        except GeomkinError as error:
            return {"problems": problems_of(error)}
        files = [
            {"name": path.name, "bytes": size, "url": quote(f"out/{name}/{path.name}")}
            for path, size in made.files.items()
        ]
        self._sources[name] = {f"{name}.toml": text, **self.workspace.files_of(text)}
        return {"problems": [], "files": files, "remarks": list(made.remarks)}

    def _listed(self, name: str) -> dict[str, Any]:
        """A recipe of the folder with the words by which it is found: kind, and first comment or what the kind is."""
        text = ""
        with suppress(GeomkinError):
            text = self.workspace.open(name).text
        lines = [line.strip() for line in text.splitlines()]
        kind = next((found for line in lines if (found := _kind_in(line))), "")
        comments = list(
            takewhile(lambda line: line[0] == "#", (line for line in lines if line and not line.startswith("#:")))
        )
        about = recipe_class(kind).about() if kind in all_kinds() else ""
        return {
            "name": name,
            "kind": kind,
            "joins": _joins(kind),
            "title": _title(" ".join(line.lstrip("# ") for line in comments)) or about,
            "words": f"{text[:LONGEST_SEARCHED]} {other_names(kind, name)}",
        }

    @cached_property
    def _examples(self) -> list[dict[str, Any]]:
        """Recipes of the gallery that need no other file; none in the gallery itself."""
        folder, known = gallery()
        home = Workspace(folder)
        if home.folder == self.workspace.folder:
            return []
        examples = []
        for file, (kind, about) in known.items():
            name = file.removesuffix(".toml")
            text = home.open(name).text
            if not home.files_of(text):
                example = {"name": name, "kind": kind, "title": _title(about), "joins": _joins(kind)}
                examples.append(example | {"words": f"{text[:LONGEST_SEARCHED]} {other_names(kind, name)}"})
        return examples

    def archive(self, folder: str) -> bytes:
        """All files of a recipe that was made, and the recipe, in one zip."""
        home, buffer = self.workspace.folder / "out" / folder, BytesIO()
        if file_name_flaw(folder) or not home.resolve().is_relative_to(self.workspace.folder):
            raise RefusedError(HTTPStatus.NOT_FOUND, "there is no such folder")
        with ZipFile(buffer, "w", ZIP_DEFLATED) as archive:
            for path in sorted(home.glob("*")):
                if path.is_file():
                    archive.writestr(path.name, self.made_file(folder, path.name))
            for name, text in self._sources.get(folder, {}).items():
                archive.writestr(name, text)
        return buffer.getvalue()

    def made_file(self, folder: str, name: str) -> bytes:
        """The content of a file that was made."""
        home = self.workspace.folder / "out" / folder
        path = home / name
        if file_name_flaw(folder) or file_name_flaw(name) or not path.resolve().is_relative_to(home):
            raise RefusedError(HTTPStatus.NOT_FOUND, "there is no such file")
        try:
            if path.is_file():
                return path.read_bytes()
        except OSError:
            pass
        raise RefusedError(HTTPStatus.NOT_FOUND, "there is no such file")

    def _picture(self, query: Mapping[str, str]) -> bytes:
        """A small picture of a recipe of the folder, or of a kind; empty if it takes a search or is wrong.

        With `moving` in the query it moves, if the mechanism does.
        """
        if "recipe" in query:
            name, text = query["recipe"], self.workspace.open(query["recipe"]).text
        elif "example" in query:
            name, text = query["example"], Workspace(gallery()[0]).open(query["example"]).text
        else:
            name, text = "", self._known_kind(query, lambda kind: template(recipe_class(kind)))
        key = text, "moving" in query
        if key not in self._pictures:
            self._pictures[key] = b"" if _is_search(text) else self._drawn(text, name, "moving" in query)
        return self._pictures[key]

    def _drawn(self, text: str, name: str, is_moving: bool) -> bytes:
        with suppress(GeomkinError):
            recipe = parse(text, "recipe", str(self.workspace.folder)).with_name(name)
            if recipe.scene is not None:
                shown, tolerance = ShownRecipe(recipe), recipe.files.tolerance
                job = Job(recipe.name or recipe.kind, shown, tolerance, unit=shown.unit)
                with suppress(DesignError):
                    return animation(job) if is_moving else assembly_picture(job)
                return assembly_picture(job)
        return b""

    def _changed(self, query: Mapping[str, str]) -> dict[str, str]:
        """The mark of a recipe's file once it is another one, or after a while."""
        name, base, end = query.get("recipe", ""), query.get("base", ""), time.monotonic() + LONGEST_WAIT
        while (mark := self.workspace.mark(name)) == base and time.monotonic() < end:
            if self._closed.wait(LOOK):
                break
        return {"base": mark}

    def _job(self, query: Mapping[str, Any]) -> BackgroundJob:
        job = self.jobs.get(str(query.get("id", "")))
        if job is None:
            raise RefusedError(HTTPStatus.NOT_FOUND, "there is no such job")
        return job

    def _known_kind(self, query: Mapping[str, Any], use: Callable[[str], Any]) -> Any:
        kind = query.get("kind")
        try:
            return use(kind if isinstance(kind, str) else "")
        except KeyError:
            raise RefusedError(
                HTTPStatus.NOT_FOUND, f"there is no kind {printable(kind)}", "give one of the list"
            ) from None


def _with_source(body: Mapping[str, Any]) -> dict[str, Any]:
    """A request with the text of the recipe of the gallery that it joins."""
    wanted = body.get("join")
    if not isinstance(wanted, dict) or "example" not in wanted:
        return dict(body)
    name = _text(wanted, "example")
    return {**body, "join": {**wanted, "name": name, "source": Workspace(gallery()[0]).open(name).text}}


def _title(about: str) -> str:
    return shorten(about, LONGEST_TITLE, placeholder="…")


def _joins(kind: str) -> bool:
    """Whether mechanisms of a kind can be on a shaft of a machine; unknown, and so not refused, for no kind."""
    return kind not in all_kinds() or recipe_class(kind).rotating_bodies is not AbstractRecipe.rotating_bodies


def _is_search(text: str) -> bool:
    """Whether a recipe's kind finds its mechanism by a search."""
    kind = next((kind for line in text.splitlines() if (kind := _kind_in(line))), "")
    return kind in KINDS and issubclass(recipe_class(kind), AbstractGoal)


def _kind_in(line: str) -> str:
    """The kind that a line of a recipe states; "" if it is another line."""
    name, equals, value = line.partition("=")
    return value.partition("#")[0].strip().strip("\"'") if equals and name.strip() == "kind" else ""


def _text(body: Mapping[str, Any], name: str) -> str:
    value = body.get(name)
    if not isinstance(value, str) or not _is_unicode(value):
        raise RefusedError(HTTPStatus.BAD_REQUEST, f"{name} is missing", "give a text")
    return value


def _is_unicode(text: str) -> bool:
    """Whether a text can be written as UTF-8, which has no halves of pairs."""
    return not any("\ud800" <= letter <= "\udfff" for letter in text)
