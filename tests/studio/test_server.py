"""The studio's server: it answers its own page only, stays in one folder, and loses no file."""

import http.client
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from contextlib import closing, suppress
from urllib.parse import urlsplit

import pytest

from geomkin.core.processes import report
from geomkin.page.page import player_file
from geomkin.studio import server as module
from geomkin.studio import service
from geomkin.studio.edit import answer
from geomkin.studio.server import HOST, LARGEST_BODY, MOST_A_SECOND, StudioServer
from geomkin.studio.service import Studio
from geomkin.studio.workspace import ConflictError, Workspace

FOUR_BAR = 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n'
POSES = 'kind = "body-guidance"\n[wanted]\nposes = [[0, 0, 0], [-20, 60, 35], [-85, 80, 90]]\n'


@pytest.fixture(autouse=True)
def state(tmp_path_factory, monkeypatch):
    """The user's folder for states, in which tokens are kept."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))


@pytest.fixture
def running(tmp_path):
    (tmp_path / "work").mkdir()
    (tmp_path / "work" / "bar.toml").write_text(FOUR_BAR)
    (tmp_path / "secret.toml").write_text(FOUR_BAR)
    server = StudioServer(Studio(Workspace(tmp_path / "work"), "bar"), 18200)
    thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    yield server
    server.shutdown()
    server.server_close()


def ask(server, name, body=None, path=None, **headers):
    """Status, headers and content of an answer."""
    connection = http.client.HTTPConnection(HOST, server.server_port, timeout=20)
    content = None if body is None else body if isinstance(body, bytes) else json.dumps(body).encode()
    given = {"Content-Type": "application/json"} if body is not None else {}
    given |= {name.replace("_", "-"): value for name, value in headers.items()}
    connection.request("GET" if body is None else "POST", path or f"/{server.token}/{name}", content, given)
    answer = connection.getresponse()
    read = answer.read()
    connection.close()
    return answer.status, answer.headers, read


def test_it_listens_on_this_machine_only_and_takes_the_next_port(running):
    assert running.server_address[0] == "127.0.0.1"
    other = StudioServer(running.studio, running.server_port)
    assert other.server_port > running.server_port and other.token != running.token
    other.server_close()


def test_it_answers_its_own_page_only(running):
    port, body = running.server_port, {"text": FOUR_BAR}
    assert ask(running, "start")[0] == 200
    for path in ("/", "/start", "/wrong/start", f"/{running.token[:-1]}/start", f"/{running.token}x/start", "//"):
        assert ask(running, "", path=path)[0] == 404, path
    for host in ("evil.example", f"evil.example:{port}", "127.0.0.1", f"127.0.0.1:{port + 1}"):
        assert ask(running, "start", Host=host)[0] == 403, host
    for origin in ("http://evil.example", "null", f"https://127.0.0.1:{port}", f"http://127.0.0.1:{port + 1}"):
        assert ask(running, "answer", body, Origin=origin)[0] == 403, origin
    assert ask(running, "answer", body, Origin=f"http://127.0.0.1:{port}", Host=f"localhost:{port}")[0] == 200


def test_a_form_of_another_page_cannot_post(running):
    for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data"):
        assert ask(running, "answer", {"text": FOUR_BAR}, Content_Type=kind)[0] == 415
    status, headers, _ = ask(running, "start")
    assert status == 200 and not any(name.lower().startswith("access-control") for name in headers)


def test_every_answer_has_a_strict_policy(running):
    for name, body in (
        ("", None),
        ("start", None),
        ("no-such", None),
        ("answer", {"text": FOUR_BAR}),
        ("answer", b"{"),
    ):
        _, headers, _ = ask(running, name, body)
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "unsafe" not in policy and "frame-ancestors 'none'" in policy
        assert headers["X-Content-Type-Options"] == "nosniff" and headers["Referrer-Policy"] == "no-referrer"


def test_bodies_are_bounded_and_must_be_objects(running):
    for body, status in (
        (b"x" * (LARGEST_BODY + 1), 413),
        (b"[1]", 400),
        (b"{", 400),
        (b"[" * 100_000, 400),
        (b"\xff", 400),
    ):
        assert ask(running, "answer", body)[0] == status
    for body in ({}, {"text": 3}, {"text": None}):
        assert ask(running, "answer", body)[0] == 400


def test_too_many_requests_are_refused(running, monkeypatch):
    monkeypatch.setattr(time, "monotonic", lambda: 5.0)
    assert [running.admit() for _ in range(module.MOST_AT_ONCE + 1)].count(True) == module.MOST_AT_ONCE
    for _ in range(module.MOST_AT_ONCE):
        running.release()
    admitted = 0
    while running.admit():
        running.release()
        admitted += 1
    assert admitted <= MOST_A_SECOND
    monkeypatch.setattr(time, "monotonic", lambda: 6.5)
    assert running.admit()


def test_the_page_that_leads_links_on_needs_and_holds_no_secret(running):
    port = running.server_port
    assert re.search(r"127\.0\.0\.1:(\d+)", player_file("links.js"))[1] == str(module.PORT)
    before = len(running._times)
    for name in ("open", "open.js"):
        with closing(http.client.HTTPConnection(HOST, port)) as connection:
            connection.request("GET", f"/{name}")
            reply = connection.getresponse()
            content = reply.read().decode()
        assert reply.status == 200 and running.token not in content + str(reply.headers)
        for method, headers in (("POST", {}), ("GET", {"Host": "example.org"}), ("GET", {"Origin": "http://a.org"})):
            with closing(http.client.HTTPConnection(HOST, port)) as connection:
                connection.request(method, f"/{name}", "{}", headers)
                assert connection.getresponse().status in (403, 404)
    # A flood of them takes nothing from the page.
    assert len(running._times) == before


def test_a_long_description_ends_with_a_word(tmp_path):
    words = [f"word{k}" for k in range(99)]
    (tmp_path / "long.toml").write_text(f"# {' '.join(words)}\n{FOUR_BAR}")
    (listed,) = Studio(Workspace(tmp_path)).get("gallery", {})["recipes"]
    title = listed["title"]
    assert title[-1] == "…" and len(title) > 200 and title[:-1].split() == words[: len(title.split())]


@pytest.mark.campaign
def test_recipes_of_the_gallery_are_offered_and_run_in_any_folder(running):
    examples = json.loads(ask(running, "examples")[2])["examples"]
    assert len(examples) > 50 and len({example["name"] for example in examples}) == len(examples)
    for example in examples[::30]:
        text = json.loads(ask(running, "new", {"example": example["name"]})[2])["text"]
        assert not answer(text, {}, {})["problems"]
    assert ask(running, f"picture?example={examples[0]['name']}")[2].startswith(b"<?xml")
    still, moving = (ask(running, f"picture?example=crank-rocker{query}")[2].decode() for query in ("", "&moving=1"))
    assert "@keyframes" in moving and "@keyframes" not in still
    for wrong in ("../pyproject", "nothing", 3):
        assert ask(running, "new", {"example": wrong})[0] in (400, 422)


NAMES = [
    "../secret",
    "..",
    ".",
    "",
    "/etc/passwd",
    "a/b",
    "C:x",
    "bar\0",
    "..\\secret",
    "x" * 300,
    7,
    None,
    ["bar"],
    "link",
]


@pytest.mark.parametrize("name", NAMES)
def test_no_name_leads_out_of_the_folder(running, tmp_path, name):
    (tmp_path / "work" / "link.toml").symlink_to(tmp_path / "secret.toml")
    assert ask(running, "open", {"recipe": name})[0] in (400, 422)
    assert ask(running, "save", {"recipe": name, "text": "x", "base": ""})[0] in (400, 422)
    assert (tmp_path / "secret.toml").read_text() == FOUR_BAR
    for path in (f"out/{name}/x", f"out/x/{name}", f"editor/{name}", f"player/../{name}"):
        assert ask(running, "", path=f"/{running.token}/{path}".replace(" ", "%20").replace("\0", "%00"))[0] == 404


def test_files_that_a_recipe_names_stay_in_the_folder(running, tmp_path):
    (tmp_path / "outside.csv").write_text("x")
    (tmp_path / "work" / "inside.csv").write_text("y")
    text = 'kind = "disk-cam"\na = ["../outside.csv", "inside.csv", "no.csv", "", "/etc/hostname"]\n'
    assert running.studio.workspace.files_of(text) == {"inside.csv": "y"}


def test_the_later_of_two_saves_is_refused(running, tmp_path):
    opened = json.loads(ask(running, "open", {"recipe": "bar"})[2])
    first = {"recipe": "bar", "text": FOUR_BAR + "# one\n", "base": opened["base"]}
    status, _, content = ask(running, "save", first)
    assert status == 200
    assert ask(running, "save", first | {"text": "# two"})[0] == 409
    assert (tmp_path / "work" / "bar.toml").read_text() == first["text"]
    assert ask(running, "save", first | {"text": "# two", "base": json.loads(content)["base"]})[0] == 200
    assert ask(running, "save", {"recipe": "bar", "text": "", "base": ""})[0] == 409
    assert ask(running, "save", {"recipe": "new one", "text": FOUR_BAR, "base": ""})[0] == 200
    # A file deleted underneath is written again.
    (tmp_path / "work" / "bar.toml").unlink()
    assert ask(running, "save", first)[0] == 200


def test_a_save_that_fails_leaves_the_old_file(running, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    base = json.loads(ask(running, "open", {"recipe": "bar"})[2])["base"]
    monkeypatch.setattr("os.fsync", full)
    status, _, content = ask(running, "save", {"recipe": "bar", "text": "# lost", "base": base})
    assert status == 422 and "space" in json.loads(content)["problems"][0]["problem"]
    assert (tmp_path / "work" / "bar.toml").read_text() == FOUR_BAR
    assert [path.name for path in (tmp_path / "work").iterdir()] == ["bar.toml"]


def test_a_change_of_the_file_is_reported(running, tmp_path):
    base = json.loads(ask(running, "open", {"recipe": "bar"})[2])["base"]
    threading.Timer(0.2, (tmp_path / "work" / "bar.toml").write_text, ["# by an editor"]).start()
    changed = json.loads(ask(running, f"changed?recipe=bar&base={base}")[2])
    assert changed["base"] != base == running.studio.workspace.mark("bar") or changed["base"]


def test_a_search_goes_on_as_a_job_that_can_be_stopped(running, monkeypatch):
    monkeypatch.setattr(service, "AT_ONCE", 0.0)
    job = json.loads(ask(running, "answer", {"text": POSES})[2])["job"]
    end = time.monotonic() + 30
    while (state := json.loads(ask(running, f"job?id={job}")[2]))["state"] == "running" and time.monotonic() < end:
        time.sleep(0.05)
    assert state["result"]["scene"] and not state["result"]["problems"]
    assert ask(running, "job?id=99")[0] == 404


def test_a_newer_request_ends_searches_but_not_one_for_checks_that_of_an_edit(running, monkeypatch):
    monkeypatch.setattr(service, "AT_ONCE", 0.0)

    def endless(*_):
        while True:
            report(0.5, "searching")
            time.sleep(0.01)

    monkeypatch.setattr(service, "answer", endless)

    def start(**lane):
        return running.studio.jobs.get(json.loads(ask(running, "answer", {"text": POSES, **lane})[2])["job"])

    scene, checks = start(), start(lane="checks")
    newer = start(lane="checks")
    assert checks.done.wait(20) and not scene.done.wait(0.05)
    last = start(lane="scene")
    assert scene.done.wait(20) and newer.done.wait(20) and not last.done.wait(0.05)
    (id,) = (id for id in map(str, range(1, 6)) if running.studio.jobs.get(id) is last)
    assert ask(running, "stop", {"id": id})[0] == 200 and last.done.wait(20) and last.result is None


def test_files_are_made_and_can_be_opened(running):
    job = json.loads(ask(running, "make", {"recipe": "bar", "text": FOUR_BAR})[2])["job"]
    assert running.studio.jobs.get(job).done.wait(60)
    result = json.loads(ask(running, f"job?id={job}")[2])["result"]
    page = next(file for file in result["files"] if file["name"] == "bar.html")
    status, headers, content = ask(running, page["url"])
    assert status == 200 and len(content) == page["bytes"] and "sandbox" in headers["Content-Security-Policy"]


def test_new_recipes_and_pictures(running):
    text = json.loads(ask(running, "new", {"kind": "slider-crank"})[2])["text"]
    assert 'kind = "slider-crank"' in text
    assert ask(running, "picture?kind=slider-crank")[2].startswith(b"<?xml")
    assert ask(running, "picture?recipe=bar")[2].startswith(b"<?xml") and ask(running, "new", {"kind": "x"})[0] == 404
    assert {row["kind"] for row in json.loads(ask(running, "gallery")[2])["kinds"]} > {"four-bar", "spur-gear"}


@pytest.mark.campaign
def test_closing_does_not_wait_for_answers_that_still_compute(running, monkeypatch):
    computing, end = threading.Semaphore(0), threading.Event()

    def compute(*_):
        computing.release()
        end.wait(60)
        return {}

    monkeypatch.setattr(service, "answer", compute)
    clients = [threading.Thread(target=ask, args=(running, "answer", {"text": FOUR_BAR}), daemon=True) for _ in "abcd"]
    for client in clients:
        client.start()
    running.studio.jobs.start(compute)
    assert all(computing.acquire(timeout=20) for _ in range(5))
    begun = time.monotonic()
    running.shutdown()
    running.server_close()
    assert time.monotonic() - begun < 4
    end.set()
    for client in clients:
        client.join(20)


def test_the_command_ends_with_ctrl_c(tmp_path):
    (tmp_path / "bar.toml").write_text(FOUR_BAR)
    command = [sys.executable, "-m", "geomkin", "studio", str(tmp_path / "bar.toml"), "--no-browser", "--port", "18300"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline().startswith("http://127.0.0.1:183")
        process.send_signal(signal.SIGINT)
        out, error = process.communicate(timeout=20)
    assert process.returncode == 0 and not out.strip() and not error.strip()
    assert [path.name for path in tmp_path.iterdir()] == ["bar.toml"]


@pytest.mark.campaign
@pytest.mark.parametrize("wait", [0.0, 0.02, 0.05, 0.11, 0.23])
def test_a_server_killed_while_saving_leaves_a_whole_file(tmp_path, wait):
    texts = [f"# {mark * 200_000}\n{FOUR_BAR}" for mark in "ab"]
    file = tmp_path / "bar.toml"
    file.write_text(texts[0])
    command = [sys.executable, "-m", "geomkin", "studio", str(file), "--no-browser", "--port", "18400"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        address = urlsplit(process.stdout.readline().strip())
        connection = http.client.HTTPConnection(HOST, address.port, timeout=20)
        base, saves = Workspace(tmp_path).mark("bar"), 0
        threading.Timer(0.1 + wait, process.kill).start()
        with closing(connection), suppress(OSError, http.client.HTTPException):
            while True:
                body = {"recipe": "bar", "text": texts[(saves + 1) % 2], "base": base}
                connection.request(
                    "POST", f"{address.path}save", json.dumps(body), {"Content-Type": "application/json"}
                )
                base = json.loads(connection.getresponse().read())["base"]
                saves += 1
    assert file.read_text() in texts and saves > 0


def test_requests_without_the_token_do_not_block_the_page(running):
    for _ in range(20):
        assert ask(running, "start", path="/wrong/start")[0] == 404
    assert not running._times


def test_a_pipe_in_the_folder_is_not_opened(running, tmp_path):
    os.mkfifo(tmp_path / "work" / "pipe.toml")
    (tmp_path / "work" / "zero.toml").symlink_to("/dev/zero")
    begun = time.monotonic()
    assert ask(running, "open", {"recipe": "pipe"})[0] == 422 and ask(running, "open", {"recipe": "zero"})[0] == 422
    assert ask(running, "save", {"recipe": "pipe", "text": "x", "base": ""})[0] in (409, 422)
    assert running.studio.workspace.mark("pipe") == "" and time.monotonic() - begun < 5


@pytest.mark.parametrize(
    ("name", "body"),
    [
        *(("answer", {"text": FOUR_BAR, key: wrong}) for key in ("set", "drag", "locks") for wrong in ("x", 7, [[1]])),
        *(("answer", {"text": FOUR_BAR, key: wrong}) for key in ("add", "lane", "recipe") for wrong in (7, ["x"], {"a": 1})),
        ("answer", {"text": "\ud800"}),
        ("save", {"recipe": "new", "text": "\ud800", "base": ""}),
        ("new", {"kind": "four-bar", "options": 5}),
        ("new", {"kind": "four-bar", "options": [[]]}),
    ],
)  # fmt: skip
def test_a_request_of_a_wrong_form_is_refused(running, name, body):
    assert ask(running, name, body)[0] == 400


def test_odd_addresses_and_values_are_no_internal_error(running):
    for path in ("//[", "x", "*", "/%00/%ff"):
        assert ask(running, "", path=path)[0] in (400, 404), path
    for values in ({"units": []}, {"a.kind": 5}, {"a.kind": []}, 3, []):
        assert ask(running, "form", {"kind": "four-bar", "values": values})[0] == 200


def test_of_simultaneous_saves_of_one_base_one_wins(tmp_path):
    (tmp_path / "bar.toml").write_text(FOUR_BAR)
    # Two servers on one folder have a workspace each.
    workspaces = [Workspace(tmp_path), Workspace(tmp_path)]
    for _ in range(10):
        base, start, won = workspaces[0].mark("bar"), threading.Barrier(6), []

        def save(k, base=base, start=start, won=won):
            start.wait()
            with suppress(ConflictError):
                won.append((k, workspaces[k % 2].save("bar", f"{FOUR_BAR}# {k} {base}\n", base)))

        threads = [threading.Thread(target=save, args=(k,)) for k in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(20)
        assert len(won) == 1 and won[0][1] == workspaces[0].mark("bar")


def test_a_folder_keeps_its_token_privately(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    token = module.kept_token(tmp_path)
    assert module.kept_token(tmp_path) == token != module.kept_token(tmp_path / "other") and len(token) >= 32
    (file, _) = sorted((tmp_path / "state").rglob("*"), key=lambda path: not path.is_file())[:2]
    assert file.stat().st_mode & 0o077 == 0
