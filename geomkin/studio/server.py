"""The studio's server, on this machine only: pages and answers for one browser tab or several."""

from __future__ import annotations

import json
import os
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from hashlib import sha256
from hmac import compare_digest
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from io import BytesIO
from itertools import takewhile
from pathlib import Path
from secrets import token_urlsafe
from socket import SHUT_RD, socket
from threading import BoundedSemaphore, Event, Lock, Thread
from typing import Any
from urllib.parse import parse_qsl, unquote, urlsplit
from zipfile import ZIP_DEFLATED, ZipFile

from .. import page
from ..build import make
from ..core.errors import DesignError, FileError, GeomkinError, Problem, RecipeError, harmless, printable
from ..core.names import file_name_flaw
from ..export.job import Job
from ..export.scene_svg import assembly_picture
from ..recipe.kinds import KINDS, all_kinds, recipe_class
from ..recipe.load import parse
from ..recipe.recipe import AbstractGoal, AbstractRecipe
from ..recipe.shown import ShownRecipe
from ..recipe.template import template
from .building import EMPTY
from .edit import Draft, answer
from .form import recipe_form
from .strokes import known_linkages
from .workspace import BackgroundJob, ConflictError, Jobs, Workspace, join_all

HOST = "127.0.0.1"
# The first port that is tried, and how many after it.
PORT, MOST_PORTS = 8017, 50
# Bytes of the secret in the address.
TOKEN = 24
# Characters of the description of a recipe in the gallery.
LONGEST_TITLE = 240
# Largest body of a request, bytes: a recipe is at most half of it.
LARGEST_BODY = 1_000_000
# Requests in any one second, and at the same time: a drag sends fewer than 60 a second.
MOST_A_SECOND, MOST_AT_ONCE = 200, 24
# Seconds after which an idle connection is closed.
IDLE = 60
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
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors "
)
# Pages that may hold the studio in a frame: none, or those of a notebook on this machine.
NOBODY = "'none'"
NOTEBOOKS = "http://localhost:* http://127.0.0.1:* https://localhost:* https://127.0.0.1:* vscode-webview:"
# Seconds for which a server that is closed waits for jobs, and for requests: enough to write a recipe. A longer
# computation is given up.
LAST_WAIT = 1.0
# For files that were made, whose texts come from recipes.
FILE_POLICY = "sandbox allow-scripts allow-downloads"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".json": "application/json",
    ".zip": "application/zip",
}


class _RefusedError(Exception):
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
        # The last recipe, whose checks are asked for after its scene, and the search that goes on.
        self._last: tuple[tuple[Any, ...], AbstractRecipe] | None = None
        # The last search for checks, and the last one for a scene.
        self._searches: dict[bool, BackgroundJob] = {}
        self._pictures: dict[str, bytes] = {}

    def get(self, name: str, query: Mapping[str, str]) -> Any:
        """The answer to a GET request."""
        match name:
            case "start":
                first, text = (self.kept.name, self.kept.text) if self.kept else (self.first, "")
                return {"first": first, "text": text, "folder": str(self.workspace.folder)}
            case "gallery":
                kinds = [
                    {"kind": kind, "group": row.group, "about": recipe_class(kind).about()}
                    for kind, row in all_kinds().items()
                ]
                return {"kinds": kinds, "recipes": [self._listed(name) for name in self.workspace.recipes]}
            case "picture":
                return self._picture(query)
            case "job":
                return self._job(query).state
            case "changed":
                return self._changed(query)
        raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such page")

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
                    raise _RefusedError(HTTPStatus.BAD_REQUEST, "options has the wrong form", "give a list of texts")
                if body.get("kind") == "":
                    return {"text": EMPTY}
                return {"text": self._known_kind(body, lambda kind: template(recipe_class(kind), options))}
            case "nearest":
                return {"known": known_linkages(body.get("points"))}
            case "make":
                id, _ = self.jobs.start(partial(self._made, _text(body, "text"), _text(body, "recipe")))
                return {"job": id}
            case "stop":
                self._job(body).stop()
                return {}
        raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such page")

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
                raise _RefusedError(HTTPStatus.BAD_REQUEST, f"{key} has the wrong form", "give what the docs state")
        if not all(isinstance(key, str) for key in body.get("locks") or ()):
            raise _RefusedError(HTTPStatus.BAD_REQUEST, "locks has the wrong form", "give keys")
        # The file of a mechanism that is joined.
        further = [f"{(body.get('join') or {}).get('recipe')}.toml"]
        work = partial(self._answered, text, self.workspace.files_of(text, further), dict(body), name)
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
            reply = answer(text, files, request, name, self._opened)
            if self.kept and request.get("lane") != "checks":
                self.kept = Draft(reply["text"], files, name)
            return reply
        except Exception as error:
            # A fault of ours must not lose the user's text.
            problem = f"internal error ({printable(f'{type(error).__name__}: {error}', 200)})"
            entry = {"key": "", "problem": problem, "remedy": "please report it", "id": "internal"}
            return {**answer("", {}, {}), "text": text, "problems": [entry]}

    def _opened(self, draft: Draft) -> AbstractRecipe:
        key = (draft.text, draft.name, tuple(sorted(draft.files.items())))
        last = self._last
        if last is None or last[0] != key:
            last = (key, draft.opened(draft.table()))
            self._last = last
        return last[1]

    def _made(self, text: str, name: str) -> dict[str, Any]:
        try:
            recipe = parse(text, name, str(self.workspace.folder)).with_name(name)
            made = make(recipe, self.workspace.folder / "out")
        except GeomkinError as error:
            return {"problems": _problems(error)}
        files = [
            {"name": path.name, "bytes": size, "url": f"out/{name}/{path.name}"} for path, size in made.files.items()
        ]
        return {"problems": [], "files": files, "remarks": list(made.remarks)}

    def _listed(self, name: str) -> dict[str, str]:
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
            "title": " ".join(line.lstrip("# ") for line in comments)[:LONGEST_TITLE] or about,
        }

    def archive(self, folder: str) -> bytes:
        """All files of a recipe that was made, in one zip."""
        home, buffer = self.workspace.folder / "out" / folder, BytesIO()
        if file_name_flaw(folder) or not home.resolve().is_relative_to(self.workspace.folder):
            raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such folder")
        with ZipFile(buffer, "w", ZIP_DEFLATED) as archive:
            for path in sorted(home.glob("*")):
                if path.is_file():
                    archive.writestr(path.name, self.made_file(folder, path.name))
        return buffer.getvalue()

    def made_file(self, folder: str, name: str) -> bytes:
        """The content of a file that was made."""
        home = self.workspace.folder / "out" / folder
        path = home / name
        if file_name_flaw(folder) or file_name_flaw(name) or not path.resolve().is_relative_to(home):
            raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such file")
        try:
            if path.is_file():
                return path.read_bytes()
        except OSError:
            pass
        raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such file")

    def _picture(self, query: Mapping[str, str]) -> bytes:
        """A small picture of a recipe of the folder, or of a kind; empty if it takes a search or is wrong."""
        if "recipe" in query:
            name, text = query["recipe"], self.workspace.open(query["recipe"]).text
        else:
            name, text = "", self._known_kind(query, lambda kind: template(recipe_class(kind)))
        if text not in self._pictures:
            self._pictures[text] = b"" if _is_search(text) else self._drawn(text, name)
        return self._pictures[text]

    def _drawn(self, text: str, name: str) -> bytes:
        with suppress(GeomkinError):
            recipe = parse(text, "recipe", str(self.workspace.folder)).with_name(name)
            if recipe.scene is not None:
                shown, tolerance = ShownRecipe(recipe), recipe.files.tolerance
                return assembly_picture(Job(recipe.name or recipe.kind, shown, tolerance, unit=shown.unit))
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
            raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such job")
        return job

    def _known_kind(self, query: Mapping[str, Any], use: Callable[[str], Any]) -> Any:
        kind = query.get("kind")
        try:
            return use(kind if isinstance(kind, str) else "")
        except KeyError:
            raise _RefusedError(
                HTTPStatus.NOT_FOUND, f"there is no kind {printable(kind)}", "give one of the list"
            ) from None


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
        raise _RefusedError(HTTPStatus.BAD_REQUEST, f"{name} is missing", "give a text")
    return value


def _is_unicode(text: str) -> bool:
    """Whether a text can be written as UTF-8, which has no halves of pairs."""
    return not any("\ud800" <= letter <= "\udfff" for letter in text)


def _problems(error: GeomkinError) -> list[dict[str, str | float]]:
    match error:
        case RecipeError():
            problems = list(error.problems)
        case DesignError():
            problems = [error.as_problem]
        case FileError():
            problems = [Problem("", f"{error.file} {error.problem}", error.remedy, error.id)]
        case _:
            problems = [Problem("", str(error), "")]
    return [problem.to_dict() for problem in problems]


class StudioServer(ThreadingHTTPServer):
    """The HTTP server of a studio.

    Parameters
    ----------
    studio : Studio
        What it answers.
    port : int
        The first port that is tried; if it is taken, the next ones. 0 for any free one.
    framed_by : str
        Sources of pages that may show the studio in a frame, as in a content security policy.
    token : str
        The secret in its address; by default a new one.
    """

    # On Windows a second server could otherwise take over the port of a running one; elsewhere a server that is started
    # again gets its port back.
    allow_reuse_address = os.name != "nt"

    def __init__(self, studio: Studio, port: int = PORT, framed_by: str = NOBODY, token: str = ""):
        self.studio, self.token, self.policy = studio, token or token_urlsafe(TOKEN), POLICY + framed_by
        # Connections that are open, by their threads.
        self._connections: dict[Thread, socket] = {}
        self._slots, self._times, self._lock = (
            BoundedSemaphore(MOST_AT_ONCE),
            deque[float](maxlen=MOST_A_SECOND),
            Lock(),
        )
        for tried in range(port, port + MOST_PORTS):
            try:
                super().__init__((HOST, tried), _Handler)
                return
            except OSError:
                continue
        raise FileError(f"port {port}", "and the next ones are taken", "give another --port", "file-unwritable")

    @property
    def url(self) -> str:
        """The address of the page, with the token without which nothing is answered."""
        return f"http://{HOST}:{self.server_port}/{self.token}/"

    def admit(self) -> bool:
        """Whether a request may be answered now: few in a second, few at the same time."""
        with self._lock:
            now = time.monotonic()
            if len(self._times) == MOST_A_SECOND and now - self._times[0] < 1:
                return False
            self._times.append(now)
        return self._slots.acquire(blocking=False)

    def release(self) -> None:
        """A request was answered."""
        self._slots.release()

    def server_close(self) -> None:
        """Stop all work, end the connections that browsers keep open, and give the port back."""
        super().server_close()
        self.studio.close()
        for connection in self._connections.values():
            with suppress(OSError):
                connection.shutdown(SHUT_RD)
        join_all(self._connections, LAST_WAIT)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer the requests of one connection in a thread of its own."""
        thread = Thread(target=self.process_request_thread, args=(request, client_address), daemon=True)
        self._connections = {t: c for t, c in self._connections.items() if t.is_alive()} | {thread: request}
        thread.start()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that leaves in the middle of an answer is no fault."""


class _Handler(BaseHTTPRequestHandler):
    server: StudioServer
    protocol_version = "HTTP/1.1"
    timeout = IDLE

    def do_GET(self) -> None:
        self._answer(self._get)

    def do_POST(self) -> None:
        self._answer(self._post)

    def version_string(self) -> str:
        return "geomkin"

    def log_message(self, format: str, *args: Any) -> None:
        """The terminal shows the address and nothing else."""

    def _answer(self, work: Callable[[str, dict[str, str]], tuple[bytes, str, str]]) -> None:
        status, policy = HTTPStatus.OK, self.server.policy
        admitted = False
        try:
            # Only requests of the studio's own page are counted.
            checked = self._checked()
            admitted = self.server.admit()
            if not admitted:
                raise _RefusedError(HTTPStatus.TOO_MANY_REQUESTS, "too many requests", "wait")
            content, kind, policy = work(*checked)
        except _RefusedError as error:
            status = error.status
            entry = {"key": "", "problem": harmless(error.problem), "remedy": error.remedy, "id": ""}
            content, kind = _json({"problems": [entry]})
        except ConflictError as error:
            status = HTTPStatus.CONFLICT
            entry = {
                "key": "",
                "problem": harmless(error),
                "remedy": "save under another name, or over it",
                "id": "conflict",
            }
            content, kind = _json({"problems": [entry]})
        except GeomkinError as error:
            status = HTTPStatus.UNPROCESSABLE_ENTITY
            content, kind = _json({"problems": _problems(error)})
        except Exception as error:
            status = HTTPStatus.INTERNAL_SERVER_ERROR
            problem = f"internal error ({printable(f'{type(error).__name__}: {error}', 200)})"
            content, kind = _json(
                {"problems": [{"key": "", "problem": problem, "remedy": "please report it", "id": "internal"}]}
            )
        finally:
            if admitted:
                self.server.release()
        if status >= HTTPStatus.BAD_REQUEST:
            # The body may not have been read.
            self.close_connection = True
        with suppress(OSError):
            self._send(status, content, kind, policy)

    def _checked(self) -> tuple[str, dict[str, str]]:
        """The name of the page and its query, if the request comes from the studio's own page."""
        port = self.server.server_port
        hosts = {f"{HOST}:{port}", f"localhost:{port}"}
        if self.headers.get("Host") not in hosts:
            raise _RefusedError(HTTPStatus.FORBIDDEN, "the request is for another host")
        origin = self.headers.get("Origin")
        if origin is not None and origin not in {f"http://{host}" for host in hosts}:
            raise _RefusedError(HTTPStatus.FORBIDDEN, "the request comes from another page")
        try:
            parts = urlsplit(self.path)
        except ValueError:
            raise _RefusedError(HTTPStatus.BAD_REQUEST, "the address is wrong") from None
        token, *rest = unquote(parts.path).removeprefix("/").split("/", 1)
        if not rest or not compare_digest(token.encode(), self.server.token.encode()):
            raise _RefusedError(
                HTTPStatus.NOT_FOUND, "the address is not that of the studio", "open the one in the terminal"
            )
        return rest[0], dict(parse_qsl(parts.query))

    def _get(self, name: str, query: dict[str, str]) -> tuple[bytes, str, str]:
        if name.startswith("zip/"):
            return self.server.studio.archive(name.removeprefix("zip/")), TYPES[".zip"], FILE_POLICY
        if name.startswith("out/"):
            _, folder, file = f"{name}//".split("/")[:3]
            kind = TYPES.get(Path(file).suffix, "application/octet-stream")
            return self.server.studio.made_file(folder, file), kind, FILE_POLICY
        if not name or "/" in name:
            return (*_page_file(name), self.server.policy)
        reply = self.server.studio.get(name, query)
        if isinstance(reply, bytes):
            return reply, TYPES[".svg"], FILE_POLICY
        return (*_json(reply), self.server.policy)

    def _post(self, name: str, query: dict[str, str]) -> tuple[bytes, str, str]:
        del query
        if self.headers.get_content_type() != "application/json":
            raise _RefusedError(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "the body is not JSON", "send application/json")
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal():
            raise _RefusedError(HTTPStatus.LENGTH_REQUIRED, "the length of the body is missing")
        if int(length) > LARGEST_BODY:
            # A browser shows the answer only if its request was read.
            self.rfile.read(min(int(length), 10 * LARGEST_BODY))
            raise _RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"the body is larger than {LARGEST_BODY:,} bytes")
        try:
            body = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            raise _RefusedError(HTTPStatus.BAD_REQUEST, "the body is not JSON") from None
        if not isinstance(body, dict):
            raise _RefusedError(HTTPStatus.BAD_REQUEST, "the body is not an object")
        return (*_json(self.server.studio.post(name, body)), self.server.policy)

    def _send(self, status: HTTPStatus, content: bytes, kind: str, policy: str) -> None:
        self.send_response(status)
        for name, value in {
            "Content-Type": kind,
            "Content-Length": str(len(content)),
            "Content-Security-Policy": policy,
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Cache-Control": "no-store",
        }.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)


def kept_token(folder: Path) -> str:
    """The token of the last studio in a folder, with which a page that is still open goes on; a new one at first.

    It is in a file of the user's own folder for states, which nobody else can read.
    """
    home = os.environ.get("XDG_STATE_HOME") or os.environ.get("LOCALAPPDATA") or str(Path.home() / ".local" / "state")
    file = Path(home, "geomkin", "studio", sha256(str(folder.resolve()).encode()).hexdigest())
    with suppress(OSError, ValueError):
        if len(token := file.read_text("ascii").strip()) >= TOKEN:
            return token
    token = token_urlsafe(TOKEN)
    with suppress(OSError):
        file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with open(file, "w", encoding="ascii", opener=partial(os.open, mode=0o600)) as state:
            state.write(token)
    return token


def _json(data: Any) -> tuple[bytes, str]:
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.encode("utf-8", "replace"), TYPES[".json"]


def _page_file(name: str) -> tuple[bytes, str]:
    """A file of the editor's page or of the player."""
    folder, *inner = (name or "editor/index.html").split("/")
    path = files(page).joinpath(folder, *inner)
    known = folder in ("editor", "player") and inner and not any(map(file_name_flaw, inner))
    if not known or Path(inner[-1]).suffix not in TYPES or not path.is_file():
        if name:
            raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such page")
        return b"<!doctype html><title>geomkin studio</title><p>The studio is running.</p>", TYPES[".html"]
    return path.read_bytes(), TYPES[Path(inner[-1]).suffix]
