"""Thousands of spoilt recipes, each in a process of its own: each is made in its folder, or refused in plain lines."""

import os
import shutil
import signal
import time
from collections import Counter

import pytest

resource = pytest.importorskip("resource", reason="processes are forked and limited as POSIX has it")

from .extremes import attempt, numbers_at_their_ends  # noqa: E402
from .mutations import GALLERY, campaign  # noqa: E402

SEED, COUNT, SHARES = 1, 2000, 40
# Of some 6,000 cases of `extremes.py`; more than these and the campaign takes longer than five minutes.
EXTREMES = 500
# A recipe that is legal may be much work; none may be more than these, nor may one that is refused.
# Seconds are of the processor, whatever else the machine does.
SECONDS, BYTES = 20, 2 << 30


def _child(folder, *arguments):
    """Run the command; the exit status shows the result."""
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    os.chdir(folder)
    for stream, name in ((1, "../stdout"), (2, "../stderr")):
        os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), stream)
    import sys
    import warnings

    sys.stdout, sys.stderr = open(1, "w", closefd=False), open(2, "w", closefd=False)  # noqa: SIM115
    warnings.simplefilter("always")
    sys.argv = ["geomkin", *arguments]
    from geomkin.__main__ import main

    try:
        main()
    except SystemExit as left:
        sys.stdout.flush()
        sys.stderr.flush()
        if isinstance(left.code, str):
            os.write(2, left.code.encode())
        os._exit(left.code if isinstance(left.code, int) else 1)
    os._exit(0)


def _ended(folder, *arguments):
    """Exit status of the command in a process of its own, or -1 for one that worked or waited too long."""
    process = os.fork()
    if not process:
        try:
            _child(folder, *arguments)
        finally:
            os._exit(99)
    until = time.monotonic() + 10 * SECONDS
    while time.monotonic() < until:
        done, status = os.waitpid(process, os.WNOHANG)
        if done:
            status = os.waitstatus_to_exitcode(status)
            return -1 if status in (-signal.SIGXCPU, -signal.SIGKILL) else status
        time.sleep(0.002)
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    return -1


def _faults(status, home, sound):
    """What is wrong with how a run ended; empty where nothing is."""
    said = (home / "stdout").read_bytes() + (home / "stderr").read_bytes()
    text = said.decode("utf-8", "replace")
    if status == -1:
        yield f"still working after {SECONDS} s, or killed"
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
    if status == 0:
        try:
            sound(made, gaps=True)
        except Exception as error:
            yield f"unsound: {type(error).__name__}: {error}"


@pytest.fixture(scope="module")
def tally():
    """(kind, how it was spoilt) -> [made, refused, survived], stated at the end."""
    counts = {}
    yield counts
    print("\nkind                     spoilt    made  refused  survived")
    for (kind, how), count in sorted(counts.items()):
        print(f"{kind:<24} {how:<8} {count['made']:>5} {count['refused']:>8} {count['survived']:>9}")
    whole = sum(counts.values(), Counter())
    print(f"{'all':<33} {whole['made']:>5} {whole['refused']:>8} {whole['survived']:>9}")


@pytest.mark.campaign
@pytest.mark.parametrize("share", range(SHARES))
def test_no_spoilt_recipe_escapes_hangs_or_breaks(tmp_path, share, tally, sound):
    import ezdxf  # noqa: F401  loaded once here, so that each process need not
    import shapely  # noqa: F401

    made, tried, faults = 0, 0, []
    for number, (name, kind, text) in enumerate(campaign(COUNT, SEED)):
        if number // 4 % SHARES != share:
            continue
        home = tmp_path / "one"
        (home / "in").mkdir(parents=True)
        shutil.copy(GALLERY / "table-cam-lift.csv", home / "in")
        (home / "in/r.toml").write_bytes(text.encode("utf-8", "surrogatepass"))
        status = _ended(home / "in", "run", "r.toml", "--out", "out")
        reported = list(_faults(status, home, sound))
        if number % 8 in (1, 4) and not reported:
            refusal = (home / "stderr").read_bytes() if status else b""
            if _ended(home / "in", "check", "r.toml") != status or (home / "stderr").read_bytes() != refusal:
                reported = [f"check says otherwise: {refusal[:300]!r}, {(home / 'stderr').read_bytes()[:300]!r}"]
        how = "renamed" if name.startswith("renamed") else "other"
        made, tried = made + (status == 0), tried + 1
        count = tally.setdefault((kind, how), Counter())
        count.update({"made": status == 0, "refused": status == 1, "survived": not reported})
        if reported:
            faults.append(f"{number} {name}: {reported}\n{text[:3000]}")
            print(faults[-1], flush=True)
        shutil.rmtree(home)
    assert 0 < made < tried, "nothing was made, or nothing refused: no campaign"
    assert not faults, "\n\n".join(faults)


@pytest.mark.campaign
@pytest.mark.parametrize("share", range(SHARES))
def test_numbers_at_their_ends_are_made_or_refused(tmp_path, share):
    import ezdxf  # noqa: F401  loaded once here, so that each process need not
    import shapely  # noqa: F401

    faults = []
    for name, text in numbers_at_their_ends(EXTREMES, SEED)[share::SHARES]:
        reported, seconds = attempt(text, tmp_path)
        if reported:
            faults.append(f"{name}: {reported} ({seconds:.1f} s)")
            print(faults[-1], flush=True)
    assert not faults, "\n".join(faults)
