"""Work shared among copies of a process: the same results, and none of them outlives the one that made them."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from geomkin.core import processes
from geomkin.core.progress import shown
from geomkin.core.progress import tell as tell_progress

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="copies are made where the system bears it")
if sys.platform == "linux" and len(os.sched_getaffinity(0)) < 2:
    pytestmark = pytest.mark.skip(reason="there is one core")

# `work` tells who did it; some of it takes longer, or is killed.
PRELUDE = """
import json, os, signal, sys, time
from geomkin.core.processes import each
def work(task):
    if task == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(task)
    return task, os.getpid()
"""


def said(code):
    run = subprocess.run([sys.executable, "-c", PRELUDE + code], capture_output=True, text=True, check=True, timeout=60)
    assert run.stderr == ""
    return json.loads(run.stdout)


def test_each_task_is_done_once_the_first_of_them_here():
    code = "tasks = [0, 0.3, 0.1, 0.2, 0.1, 0.1]; begun = []\nprint(json.dumps([os.getpid(), tasks, list(each(work, tasks, begun.append)), begun]))"
    here, tasks, found, begun = said(code)
    assert sorted((number, task) for number, (task, _) in found) == list(enumerate(tasks))
    assert begun == tasks and found[0][1][1] == here
    copies = {pid for _, (_, pid) in found[1:]}
    assert here not in copies and len(copies) == min(len(os.sched_getaffinity(0)), 5)


@pytest.mark.parametrize("tasks", ["[0, 0, 0]", "[0]", "[]"])
def test_few_tasks_are_done_here(tasks):
    here, found = said(f"print(json.dumps([os.getpid(), list(each(work, {tasks}))]))")
    assert [pid for _, (_, pid) in found] == [here] * len(json.loads(tasks))


@pytest.mark.parametrize(
    "why",
    [
        "os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])",
        "import threading; threading.Thread(target=time.sleep, args=(2,)).start()",
    ],
)
def test_one_core_or_a_thread_that_no_copy_has_leaves_all_here(why):
    here, found = said(f"{why}\nprint(json.dumps([os.getpid(), list(each(work, [0] * 6))]))")
    assert {pid for _, (_, pid) in found} == {here}


def test_a_copy_that_is_killed_costs_its_task_alone():
    found = said("print(json.dumps(sorted(each(work, [0, 'kill', 0, 'kill', 'kill', 0, 0]))))")
    assert [number for number, result in found if result is None] == [1, 3, 4] and len(found) == 7


def work_here(task):
    """Who did a task; told aloud, which no copy does; some are killed, some take long."""
    tell_progress(0.5, "working")
    if task == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(task)
    return task, os.getpid()


@pytest.fixture
def two_copies(monkeypatch):
    """Two copies whatever runs beside these tests in threads of its own; handlers are put back."""
    before = {number: signal.getsignal(number) for number in processes.ENDS}
    monkeypatch.setattr(processes, "_cores", lambda: 2)
    monkeypatch.setattr(processes, "_can_be_copied", lambda: True)
    yield before
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_tasks_are_dealt_out_from_this_process_and_nothing_of_it_stays(two_copies):
    tasks, begun, told, during = [0, 0.05, "kill", 0.01, 0, "kill", 0.02], [], [], []
    with shown(lambda *given: told.append(given)):
        found = {}
        for number, made in processes.each(work_here, tasks, begun.append):
            found[number] = made
            during.append(len(multiprocessing.active_children()))
    assert begun == tasks and sorted(found) == list(range(len(tasks)))
    assert [number for number, made in found.items() if made is None] == [2, 5]
    assert all(made[0] == tasks[number] for number, made in found.items() if made)
    assert found[0][1] == os.getpid() and not {made[1] for k, made in found.items() if made and k} & {os.getpid()}
    # Copies are as many as asked for until there is nothing to deal; one that was killed is made up for.
    assert max(during) == 2 and multiprocessing.active_children() == []
    assert told == [(0.5, "working")]
    assert {number: signal.getsignal(number) for number in processes.ENDS} == two_copies


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
@pytest.mark.parametrize("end", processes.ENDS)
def test_an_end_goes_on_to_whoever_awaited_it_when_the_copies_are_gone(two_copies, end):
    copies = []

    def awaited(number, frame):
        assert number == end and frame is not None and multiprocessing.active_children() == []
        raise InterruptedError

    signal.signal(end, awaited)
    started = time.monotonic()
    with pytest.raises(InterruptedError):
        for number, _ in processes.each(work_here, [0, 0, 50, 50]):
            if number == 1:
                copies += multiprocessing.active_children()
                os.kill(os.getpid(), end)
    assert len(copies) == 2 and multiprocessing.active_children() == [] and time.monotonic() - started < 40
    assert signal.getsignal(end) == awaited


def test_where_nothing_tells_of_threads_all_is_done_here(two_copies, monkeypatch):
    monkeypatch.undo()
    monkeypatch.setattr(processes, "_cores", lambda: 2)
    monkeypatch.setattr(os, "listdir", lambda folder: (_ for _ in ()).throw(PermissionError(13, "not to be read")))
    assert {made[1] for _, made in processes.each(work_here, [0] * 6)} == {os.getpid()}


def alive(pid):
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize("handler", ["SIG_DFL", "default_int_handler"])
def test_no_copy_outlives_the_one_that_made_it(end, handler):
    # Where nothing can be told any more, a copy ends with the task that it is at.
    long = 0.5 if end == signal.SIGKILL else 60
    code = f"""
signal.signal(signal.SIGINT, signal.{handler})
def begun(task):
    if task:
        print(open(f"/proc/self/task/{{os.getpid()}}/children").read(), flush=True)
list(each(work, [0] + [{long}] * 50, begun))
"""
    process = subprocess.Popen(
        [sys.executable, "-c", PRELUDE + code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    process.stdout.readline()
    copies = [int(pid) for pid in process.stdout.readline().split()]
    assert len(copies) == 2 and all(map(alive, copies))
    process.send_signal(end)
    assert process.wait(10) != 0
    until = time.monotonic() + 5
    while any(map(alive, copies)) and time.monotonic() < until:
        time.sleep(0.02)
    assert not any(map(alive, copies))
    process.communicate()


RECIPES = {
    "a": 'kind = "spur-gear"\n[gear]\nteeth = 12\nmodule = 2\n',
    "b": 'kind = "spur-gear"\n[gear]\nteeth = 2\nmodule = 2\n',
    "c": 'kind = "nothing"\n',
    "d": 'kind = "spur-gear"\n[gear]\nteeth = 15\nmodule = 2\n',
    "e": 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n[drive]\nstep_deg = 10\n',
}


def test_a_folder_makes_the_same_whatever_the_cores(tmp_path):
    (tmp_path / "in").mkdir()
    for name, text in RECIPES.items():
        (tmp_path / "in" / f"{name}.toml").write_text(text)
    told = []
    for cores in (sorted(os.sched_getaffinity(0))[:1], sorted(os.sched_getaffinity(0))):
        # The same name of the folder, which is in what is said.
        home = tmp_path / f"cores-{len(cores)}"
        home.mkdir()
        call = [sys.executable, "-m", "geomkin", "run", "../in", "--only", "csv,svg"]
        run = subprocess.run(call, cwd=home, capture_output=True, preexec_fn=lambda: os.sched_setaffinity(0, cores))
        files = {str(path.relative_to(home)): path.read_bytes() for path in home.rglob("*") if path.is_file()}
        told.append((run.returncode, run.stdout, run.stderr, files))
    assert told[0] == told[1]
    assert told[0][0] == 1 and len(told[0][3]) == 9 and told[0][2].count(b"\n") >= 2


def test_where_a_system_does_not_say_which_cores_are_ours_there_is_one(monkeypatch):
    monkeypatch.delattr(os, "sched_getaffinity")
    assert processes._cores() == 1


@pytest.mark.parametrize("tasks", [(), "a", "abc", "abcdef"])
def test_where_no_copies_are_made_each_task_comes_in_its_turn_with_its_number(tasks, monkeypatch):
    monkeypatch.setattr(processes, "_cores", lambda: 1)
    done, begun = [], []

    def work(task):
        done.append(task)
        return task.upper()

    # What is taken up is told before it is done, and nothing is done before it is asked for.
    found = processes.each(work, tasks, lambda task: begun.append((task, len(done))))
    assert [*zip(range(len(tasks)), map(str.upper, tasks))] == list(found)
    assert begun == [(task, k) for k, task in enumerate(tasks)]
    first = processes.each(work, "xyz")
    assert next(first) == (0, "X") and done[-1] == "x"
