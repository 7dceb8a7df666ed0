"""Killed or interrupted at any moment: every file is whole, and an interrupt ends it at once and quietly."""

import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals as POSIX has them")

# The seams of writing a file, met once for each of it: a signal comes just before or just after.
AT_CALL = """
import os, signal
calls, real = 0, os.{name}
def met(*arguments, **options):
    global calls
    calls += 1
    if calls == {count} and "{when}" == "before":
        os.kill(os.getpid(), signal.{signal})
    value = real(*arguments, **options)
    if calls == {count} and "{when}" == "after":
        os.kill(os.getpid(), signal.{signal})
    return value
os.{name} = met
"""
# A finder that finds nothing, and interrupts when a certain module is about to be loaded.
AT_IMPORT = """
import os, signal, sys
class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == "{name}":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupt())
"""


def contents(folder):
    """Name to bytes of every file in a folder, but for temporary ones."""
    return {p.name: p.read_bytes() for p in Path(folder).iterdir() if not p.name.startswith(".")}


@pytest.fixture(scope="module")
def made(recipe, tmp_path_factory):
    """A folder with the old and the new version of a recipe, and what each makes in a process of its own."""
    folder = tmp_path_factory.mktemp("made")
    for version, crank in (("old", "30"), ("new", "25")):
        text = recipe("four-bar", {"files.write": '["dxf", "svg", "csv"]', "linkage.crank": crank})
        (folder / version).mkdir()
        (folder / version / "r.toml").write_text(text)
    code = "from geomkin import make\nfor version in 'old', 'new':\n    make(f'{version}/r.toml', version)"
    subprocess.run([sys.executable, "-c", code], cwd=folder, check=True)
    return folder


@pytest.fixture
def replaced(made, here):
    """out/r/ holds what the old version makes, r.toml the new one; judges every file old or new, counts the new."""
    shutil.copytree(made / "old", here / "out")
    shutil.copy(made / "new/r.toml", here)
    old, new = contents(made / "old/r"), contents(made / "new/r")

    def judge(out="out"):
        now = contents(f"{out}/r")
        assert sorted(now) == sorted(old)
        assert [name for name in now if now[name] not in (old[name], new[name])] == []
        return sum(now[name] == new[name] != old[name] for name in now)

    return judge


@pytest.mark.parametrize(
    ("name", "when", "count", "most"),
    [
        pytest.param("fsync", "before", 1, 0, marks=pytest.mark.campaign),
        pytest.param("fsync", "after", 2, 1, marks=pytest.mark.campaign),
        ("replace", "before", 1, 0),
        pytest.param("replace", "after", 4, 4, marks=pytest.mark.campaign),
    ],
)
def test_killed_at_a_seam_every_file_is_old_or_new(command, replaced, name, when, count, most):
    before = AT_CALL.format(name=name, when=when, count=count, signal="SIGKILL")
    done = command("run", "r.toml", before=before)
    assert done.returncode == -signal.SIGKILL
    assert replaced() <= most


@pytest.mark.parametrize("share", [0.5, *(pytest.param(share, marks=pytest.mark.campaign) for share in (0.01, 0.9))])
def test_killed_in_the_middle_of_a_file_every_file_is_old_or_new(command, made, replaced, share):
    # A process that ignores the limit on a file's size is killed at the byte that passes it.
    limit = int(share * max(map(len, contents(made / "new/r").values())))
    before = (
        "import resource, signal; signal.signal(signal.SIGXFSZ, signal.SIG_DFL)\n"
        "resource.setrlimit(resource.RLIMIT_CORE, (0, 0))\n"
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))"
    )
    assert command("run", "r.toml", before=before).returncode == -signal.SIGXFSZ
    replaced()


# With everything loaded once, a copy of the process makes the recipe in some 10 ms, or in far more on a machine that
# has much else to do: one that was killed gives the next more time, one that came to its end gives it less.
KILLED_COPIES = """
import os, random, signal, sys, time
from geomkin import make
import geomkin.export.tables, geomkin.export.dxf, geomkin.export.svg
chance = random.Random(20)
make("r.toml", "loaded")
start = time.perf_counter()
make("r.toml", "timed")
wait = time.perf_counter() - start
for k in range(int(sys.argv[1])):
    if (copy := os.fork()) == 0:
        make("r.toml", f"out{k}")
        os._exit(0)
    time.sleep(wait)
    os.kill(copy, signal.SIGKILL)
    killed = os.WIFSIGNALED(os.waitpid(copy, 0)[1])
    wait *= 1 + chance.random() if killed else chance.random()
"""


@pytest.mark.campaign
def test_killed_at_random_every_file_is_old_or_new(replaced, here, count=200):
    for k in range(count):
        shutil.copytree(here / "out", here / f"out{k}")
    subprocess.run([sys.executable, "-c", KILLED_COPIES, str(count)], check=True)
    fresh = [replaced(f"out{k}") for k in range(count)]
    assert min(fresh) < 4 <= max(fresh), "no kill came in between"


@pytest.mark.campaign
@pytest.mark.parametrize(("name", "count"), [("fsync", 3), pytest.param("replace", 2, marks=pytest.mark.campaign)])
def test_interrupted_while_writing_every_file_is_whole_and_none_is_left_over(command, replaced, here, name, count):
    before = AT_CALL.format(name=name, when="before", count=count, signal="SIGINT")
    done = command("run", "r.toml", before=before)
    assert done.returncode != 0
    replaced()
    assert list((here / "out/r").glob(".*")) == []


LOADED = ["geomkin.build"]
MORE = ["click", "numpy", "geomkin.export.solids", "shapely", "ezdxf.acc.vector", "shapely.lib"]


@pytest.mark.parametrize("name", [*LOADED, *(pytest.param(name, marks=pytest.mark.campaign) for name in MORE)])
def test_interrupted_while_loading_it_ends_at_once(command, recipe, here, name):
    (here / "r.toml").write_text(recipe("four-bar"))
    done = command("run", "r.toml", before=AT_IMPORT.format(name=name))
    assert done.returncode != 0, "the interrupt was lost"
    assert not (here / "out").exists()
    # A status of its own: 1 would say that a recipe is at fault.
    assert done.returncode == 130 and done.stderr.count("\n") == 1


# Counts the calls of functions from the program's first line on, and interrupts at one of them.
AT_FUNCTION = """
import os, signal, sys
left = {count}
def met(frame, event, argument):
    global left
    if event == "call":
        left -= 1
        if left == 0:
            sys.setprofile(None)
            os.kill(os.getpid(), signal.SIGINT)
import geomkin.__main__ as door
start, exit = door.main, os._exit
def main():
    sys.setprofile(met)
    try:
        start()
    finally:
        sys.setprofile(None)
        print({count} - left)
door.main = main
"""
NEVER = 10**9


@pytest.fixture(scope="module")
def calls_in_all(recipe, tmp_path_factory):
    """How many functions a whole run calls."""
    folder = tmp_path_factory.mktemp("calls")
    (folder / "r.toml").write_text(recipe("four-bar"))
    code = AT_FUNCTION.format(count=NEVER) + "door.main()"
    call = [sys.executable, "-c", code, "run", "r.toml", "--only", "csv"]
    return int(subprocess.run(call, cwd=folder, capture_output=True, text=True, check=True).stdout.split()[-1])


@pytest.mark.campaign
@pytest.mark.parametrize("moment", [2, 12, 22])
def test_interrupted_at_any_moment_it_says_so_in_one_line(command, recipe, here, calls_in_all, moment):
    (here / "r.toml").write_text(recipe("four-bar"))
    # A third of them while the command itself is loaded.
    share = (moment + 1) / 1000 if moment < 10 else (moment - 9) / 22
    done = command("run", "r.toml", "--only", "csv", before=AT_FUNCTION.format(count=max(1, int(share * calls_in_all))))
    assert done.returncode == 130 and done.stderr.count("\n") == 1
    assert list(here.rglob(".making*")) == [] and all(p.read_text().endswith("\n") for p in here.rglob("*.csv"))


@pytest.mark.campaign
def test_interrupted_while_a_library_computes_it_ends_at_once(here, recipe):
    # A solid of some 100,000 corners keeps a library busy for many seconds, in which Python sees no signal.
    gear = {"gear.module": "1000", "files.tolerance": "2e-5", "files.write": '["stl"]'}
    (here / "r.toml").write_text(recipe("spur-gear", gear))
    process = subprocess.Popen([sys.executable, "-m", "geomkin", "run", "r.toml"], stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    if process.poll() is not None:
        process.communicate()
        assert process.returncode in (0, 1)  # done, or refused, before a person could lose patience
        return
    process.send_signal(signal.SIGINT)
    try:
        stderr = process.communicate(timeout=5)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        pytest.fail("still busy 5 s after the interrupt")
    assert "Traceback" not in stderr and not (here / "out").exists()
