"""The studio's server, on this machine only: pages and answers for one browser tab or several."""

from __future__ import annotations

import json
import os
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from hashlib import sha256
from hmac import compare_digest
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from pathlib import Path
from secrets import token_urlsafe
from socket import SHUT_RD, socket
from threading import BoundedSemaphore, Lock, Thread
from typing import Any
from urllib.parse import parse_qsl, unquote, urlsplit

from .. import page
from ..core.errors import FileError, GeomkinError, harmless, printable
from ..core.names import file_name_flaw
from .edit import problems_of
from .service import LAST_WAIT, RefusedError, Studio
from .workspace import ConflictError, join_all

HOST = "127.0.0.1"
# The first port that is tried, and how many after it.
PORT, MOST_PORTS = 8017, 50
# Bytes of the secret in the address.
TOKEN = 24
# Largest body of a request, bytes: a recipe is at most half of it.
LARGEST_BODY = 1_000_000
# Requests in any one second, and at the same time: a drag sends fewer than 60 a second.
MOST_A_SECOND, MOST_AT_ONCE = 200, 24
# Seconds after which an idle connection is closed.
IDLE = 60
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors "
)
# Pages that may hold the studio in a frame: none, or those of a notebook on this machine.
NOBODY = "'none'"
NOTEBOOKS = "http://localhost:* http://127.0.0.1:* https://localhost:* https://127.0.0.1:* vscode-webview:"
# For files that were made, whose texts come from recipes.
FILE_POLICY = "sandbox allow-scripts allow-downloads"
# Pages that hold no secret and need none: one that leads a link to the studio that its browser opened last.
PUBLIC = {"/open": "editor/open.html", "/open.js": "editor/open.js"}
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".json": "application/json",
    ".zip": "application/zip",
}


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
            if checked[0] not in PUBLIC.values():
                admitted = self.server.admit()
                if not admitted:
                    raise RefusedError(HTTPStatus.TOO_MANY_REQUESTS, "too many requests", "wait")
            content, kind, policy = work(*checked)
        except RefusedError as error:
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
            content, kind = _json({"problems": problems_of(error)})
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
            raise RefusedError(HTTPStatus.FORBIDDEN, "the request is for another host")
        origin = self.headers.get("Origin")
        if origin is not None and origin not in {f"http://{host}" for host in hosts}:
            raise RefusedError(HTTPStatus.FORBIDDEN, "the request comes from another page")
        try:
            parts = urlsplit(self.path)
        except ValueError:
            raise RefusedError(HTTPStatus.BAD_REQUEST, "the address is wrong") from None
        if self.command == "GET" and parts.path in PUBLIC:
            return PUBLIC[parts.path], {}
        token, *rest = unquote(parts.path).removeprefix("/").split("/", 1)
        if not rest or not compare_digest(token.encode(), self.server.token.encode()):
            raise RefusedError(
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
            raise RefusedError(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "the body is not JSON", "send application/json")
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal():
            raise RefusedError(HTTPStatus.LENGTH_REQUIRED, "the length of the body is missing")
        if int(length) > LARGEST_BODY:
            # A browser shows the answer only if its request was read.
            self.rfile.read(min(int(length), 10 * LARGEST_BODY))
            raise RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"the body is larger than {LARGEST_BODY:,} bytes")
        try:
            body = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            raise RefusedError(HTTPStatus.BAD_REQUEST, "the body is not JSON") from None
        if not isinstance(body, dict):
            raise RefusedError(HTTPStatus.BAD_REQUEST, "the body is not an object")
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
            raise RefusedError(HTTPStatus.NOT_FOUND, "there is no such page")
        return b"<!doctype html><title>geomkin studio</title><p>The studio is running.</p>", TYPES[".html"]
    return path.read_bytes(), TYPES[Path(inner[-1]).suffix]
