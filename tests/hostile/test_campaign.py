"""Thousands of spoilt recipes, each in a process of its own: each is made or told in plain lines, and in its folder."""

import json
import os
import resource
import shutil
import signal
import time

import pytest

from .mutations import campaign

COUNT, SEED = int(os.environ.get("HOSTILE_RECIPES", 2000)), int(os.environ.get("HOSTILE_SEED", 1))
# A recipe that is legal may be much work; none may be more than these, nor may one that is refused.
SECONDS, BYTES = 60, 3 << 30
CAN_FORK = hasattr(os, "fork")


def _child(folder, text):
    """Run the command on the recipe; the exit status tells how it went."""
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    os.chdir(folder)
    for stream, name in ((1, "../stdout"), (2, "../stderr")):
        os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), stream)
    import sys
    import warnings

    sys.stdout, sys.stderr = open(1, "w", closefd=False), open(2, "w", closefd=False)
    warnings.simplefilter("always")
    sys.argv = ["geomkin", "run", "r.toml", "--out", "out"]
    from geomkin.cli import main

    try:
        main()
    except SystemExit as left:
        sys.stdout.flush()
        sys.stderr.flush()
        if isinstance(left.code, str):
            os.write(2, left.code.encode())
        os._exit(left.code if isinstance(left.code, int) else 1)
    os._exit(0)


def _ended(process):
    """Exit status, or -1 for a process that had to be killed."""
    until = time.monotonic() + SECONDS
    while time.monotonic() < until:
        done, status = os.waitpid(process, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.002)
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    return -1


def _faults(status, home):
    """What is wrong with how a run ended; empty where nothing is."""
    said = (home / "stdout").read_bytes() + (home / "stderr").read_bytes()
    text = said.decode("utf-8", "replace")
    if status == -1:
        yield f"still working after {SECONDS} s"
    elif status not in (0, 1):
        yield f"ended with {status}"
    for word in ("Traceback", "Warning", "please report", "not enough memory"):
        if word in text:
            yield f"{word}: {text[:300]!r}"
    if any(not line.isprintable() for line in text.split("\n")):
        yield f"not printable: {text[:300]!r}"
    lines = [line for line in text.splitlines() if line]
    if status == 1 and not (lines and all(line.startswith(("r.toml: ", "out/")) and "; " in line for line in lines)):
        yield f"not refused by file, key and remedy: {text[:300]!r}"
    made = home / "in/out/r"
    own = {home / "stdout", home / "stderr", home / "in/r.toml", home / "in/table-cam-lift.csv"}
    outside = [p for p in home.rglob("*") if p.is_file() and p.parent != made and p not in own]
    if outside or os.path.exists("/tmp/geomkin-evil"):
        yield f"files elsewhere: {outside}"
    if (summary := made / "summary.json").exists():
        json.loads(summary.read_text("utf-8"))


@pytest.mark.campaign
@pytest.mark.skipif(not CAN_FORK, reason="processes are made by fork")
@pytest.mark.parametrize("share", range(8))
def test_no_spoilt_recipe_escapes_hangs_or_breaks(tmp_path, share):
    import ezdxf  # noqa: F401  loaded once here, so that each process need not
    import shapely  # noqa: F401
    import trimesh.creation  # noqa: F401
    from geomkin import build  # noqa: F401

    from .mutations import GALLERY

    survived, made, faults = 0, 0, []
    for number, (name, text) in enumerate(campaign(COUNT, SEED)):
        if number // 4 % 8 != share:
            continue
        home = tmp_path / "one"
        (home / "in").mkdir(parents=True)
        shutil.copy(GALLERY / "table-cam-lift.csv", home / "in")
        (home / "in/r.toml").write_bytes(text.encode("utf-8", "surrogatepass"))
        process = os.fork()
        if not process:
            try:
                _child(home / "in", text)
            finally:
                os._exit(99)
        status = _ended(process)
        told = list(_faults(status, home))
        made += status == 0
        survived += not told
        if told:
            faults.append(f"{number} {name}: {told}\n{text[:3000]}")
        shutil.rmtree(home)
    print(f"{survived} of {survived + len(faults)} survived, {made} of them made")
    assert 0 < made < survived + len(faults), "nothing was made, or nothing refused: no campaign"
    assert not faults, "\n\n".join(faults)
