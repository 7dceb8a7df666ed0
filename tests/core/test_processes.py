"""Work shared among processes: results in order, the same for any number, and no process outlives its parent."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(
    not hasattr(os, "sched_getaffinity") or len(os.sched_getaffinity(0)) < 2, reason="needs two cores on Linux"
)

MODULE = """
import json, os, signal, sys, time
from geomkin.core.processes import each

def work(task):
    if task == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if task > 10:
        print(os.getpid(), flush=True)
    time.sleep(task)
    return task, os.getpid()

if __name__ == "__main__":
    print(json.dumps([os.getpid(), list(each(work, json.loads(sys.argv[1])))]))
"""


@pytest.fixture
def call(tmp_path):
    (tmp_path / "working.py").write_text(MODULE)
    return lambda tasks: [sys.executable, str(tmp_path / "working.py"), json.dumps(tasks)]


def results(call):
    run = subprocess.run(call, capture_output=True, text=True, check=True, timeout=60)
    assert run.stderr == ""
    return json.loads(run.stdout)


def test_results_come_in_the_order_of_the_tasks_from_other_processes(call):
    tasks = [0.3, 0, 0.1, 0, 0, 0.1, 0, 0, 0]
    here, found = results(call(tasks))
    assert [task for task, _ in found] == tasks and here not in {pid for _, pid in found}
    assert 1 <= len({pid for _, pid in found}) <= len(os.sched_getaffinity(0))


def test_a_killed_process_loses_its_own_task_only(call):
    tasks = [0, "kill", 0, 0, "kill", "kill", 0, 0, 0]
    _, found = results(call(tasks))
    assert [result and result[0] for result in found] == [None if task == "kill" else task for task in tasks]


def alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("end", [signal.SIGTERM, signal.SIGKILL])
def test_no_process_outlives_its_parent(call, end):
    process = subprocess.Popen(call([60] * 8), stdout=subprocess.PIPE, text=True)
    workers = [int(process.stdout.readline()) for _ in range(2)]
    assert all(map(alive, workers))
    process.send_signal(end)
    assert process.wait(10) == -end
    until = time.monotonic() + 10
    while any(map(alive, workers)) and time.monotonic() < until:
        time.sleep(0.02)
    assert not any(map(alive, workers))
    process.stdout.close()


@pytest.mark.parametrize("whole_group", [True, pytest.param(False, marks=pytest.mark.campaign)])
def test_an_interrupted_command_ends_with_its_processes(tmp_path, whole_group):
    """Ctrl-C in a terminal goes to the whole group; another program may send it to the command alone."""
    for k in range(40):
        (tmp_path / f"{k}.toml").write_text('kind = "spur-gear"\n[gear]\nteeth = 90\nmodule = 2\n')
    command = [sys.executable, "-m", "geomkin", "run", ".", "--out", "out"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, start_new_session=True)
    until = time.monotonic() + 30
    while len(list(tmp_path.glob("out/*"))) < 2 and time.monotonic() < until:
        time.sleep(0.02)
    (os.killpg if whole_group else os.kill)(process.pid, signal.SIGINT)
    assert process.wait(10) == 130
    assert len(process.stderr.read().split("\n")) <= 3
    made = len(list(tmp_path.glob("out/*")))
    time.sleep(1)
    assert len(list(tmp_path.glob("out/*"))) == made < 40
    process.stderr.close()


RECIPES = {
    "a": 'kind = "spur-gear"\n[gear]\nteeth = 12\nmodule = 2\n',
    "b": 'kind = "spur-gear"\n[gear]\nteeth = 2\nmodule = 2\n',
    "c": 'kind = "nothing"\n',
    "d": 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n[drive]\nstep_deg = 10\n',
} | {f"e{k}": f'kind = "spur-gear"\n[gear]\nteeth = {15 + k}\nmodule = 2\n' for k in range(5)}


@pytest.mark.campaign
def test_a_folder_makes_the_same_with_any_number_of_cores(tmp_path):
    (tmp_path / "in").mkdir()
    for name, text in RECIPES.items():
        (tmp_path / "in" / f"{name}.toml").write_text(text)
    found = []
    for cores in (sorted(os.sched_getaffinity(0))[:1], sorted(os.sched_getaffinity(0))):
        home = tmp_path / f"cores-{len(cores)}"
        home.mkdir()
        command = [sys.executable, "-m", "geomkin", "run", "../in", "--only", "csv,svg"]
        run = subprocess.run(command, cwd=home, capture_output=True, preexec_fn=lambda: os.sched_setaffinity(0, cores))
        files = {str(path.relative_to(home)): path.read_bytes() for path in home.rglob("*") if path.is_file()}
        found.append((run.returncode, run.stdout, run.stderr, files))
    assert found[0] == found[1] and found[0][0] == 1 and len(found[0][3]) > 14
