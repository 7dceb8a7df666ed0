"""Faults put into the source one at a time, and whether a test sees them.

    pip install -e '.[test]' coverage
    python tests/mutation/campaign.py map            # once, minutes: which tests run which line
    python tests/mutation/campaign.py run 200 7      # 200 faults chosen by seed 7, two at a time
    python tests/mutation/campaign.py hunt 200 7 geomkin/gear geomkin/cam   # the first look alone, in these files
    python tests/mutation/campaign.py one geomkin/gear/ring.py:152

Each fault is one change of one operator, number, name, sign or condition of a random line. The tests that run the line
are run until one fails, the quickest first, for so many seconds: in a fork of a process that has them ready, or, for a
fault in what is run at import, in a copy of the project. What survives is tried again, in a copy, with all tests that
run the line, the folder of tests that has the name of the source's folder, the kept drawings, and that folder's
campaigns.
What then survives is for a person to judge: some changes alter nothing that can be seen (an equal bound, a message's
wording, an example's size, a speed). The first look takes half a second a fault in a fork and 5 in a copy, the second a
minute or more a survivor.

The map leaves out the tests that work in processes of their own for long (kills, same bytes), so a fault that only they
would see is printed as a survivor. After tests are renamed the map has to be drawn again: in a fork a test that is not
found is left out, in a copy it looks like one that fails.
"""

import concurrent.futures
import functools
import json
import os
import queue
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import coverage
from faults import ROOT, drawn, faults, put, shown

MAP = ROOT / ".mutation"
LEFT_OUT = ["tests/hostile/test_killed_runs.py", "tests/hostile/test_same_bytes.py", "tests/test_gallery.py"]
GALLERY = "tests/test_gallery.py"
# Reads what is written where classes are made, so it is tried for every line that is run while the source is imported.
AT_IMPORT = "tests/core/test_fields.py"
# Of the tests that run a line, as many as take this long together are tried first: more, and a survivor costs minutes.
SECONDS = 15
# Seconds after which tests of a second look count as hanging: campaigns of one folder take up to ten minutes.
LONGEST = 3600
# Two whole suites and a fault each: what asks for more fails instead of taking the machine down.
MEMORY = 12 << 30


def draw_map():
    """Run the suite once and note which test runs which line, and each test's seconds."""
    shutil.rmtree(MAP, ignore_errors=True)
    MAP.mkdir()
    left_out = [f"--ignore={file}" for file in LEFT_OUT]
    plugin = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}
    subprocess.run([sys.executable, "-m", "pytest", "-p", "drawing", "-n", "2", *left_out], cwd=ROOT, env=plugin)


@functools.cache
def tests_by_line(file):
    """{line: names of the tests that run it}; a test file's own name stands for what it runs at import."""
    found = {}
    for part in MAP.glob("map.*"):
        data = coverage.CoverageData(part)
        data.read()
        for line, contexts in data.contexts_by_lineno(str(ROOT / file)).items():
            found.setdefault(line, set()).update(context for context in contexts if context)
    return found


def room_of(file):
    return f"tests/{Path(file).parts[1]}"


def quickest(names, seconds, folder):
    """The tests that are tried, and how long they take: the source's own folder first, quick ones first."""
    chosen, total = [], 0
    for name in sorted(names, key=lambda n: (not n.startswith(folder), seconds.get(n, SECONDS / 4), n)):
        if total + seconds.get(name, SECONDS / 4) < SECONDS:
            chosen.append(name)
            total += seconds.get(name, SECONDS / 4)
    return chosen, total


def try_fault(home, file, fault, seconds):
    """What became of a fault in the copy at `home`: "caught", "survived" or "not run" by any test of the map."""
    folder = room_of(file)
    names = tests_by_line(file).get(fault[0], set())
    chosen, expected = quickest(names, seconds, folder)
    if any("::" not in name for name in names):
        chosen.append(AT_IMPORT)
    own = [name for name in chosen if name.startswith(folder)]
    rounds = own, [name for name in chosen if name not in own]
    if not chosen:
        return "not run"
    with put(home, file, fault):
        return "survived" if all(_pass(home, tests, 60 + 10 * expected) for tests in rounds) else "caught"


def look_again(home, file, fault):
    """Try a survivor with all tests that run the line and those of its name, then with the kept drawings and campaigns."""
    room = Path(file).parts[1]
    folder = f"tests/{room}" if (home / "tests" / room).is_dir() else f"tests/test_{room}"
    named = [folder] * (home / folder).exists()
    tests = sorted(name for name in tests_by_line(file).get(fault[0], ()) if not name.startswith(folder))
    with put(home, file, fault):
        for what, again in (
            ("at the second look", [*named, AT_IMPORT, *tests]),
            ("by the kept drawings only", [GALLERY]),
            ("by the campaigns only", [*named, "-m", "campaign"] if named else []),
        ):
            if not _pass(home, again, LONGEST):
                return f"caught {what}"
        return "survived"


def _pass(home, tests, limit):
    """Whether tests pass within a time: a fault that hangs is seen, too."""
    if not tests:
        return True
    command = [sys.executable, "-m", "pytest", "-x", "-p", "no:cacheprovider", *tests]
    environment = os.environ | {"PYTHONPATH": str(home)}
    with subprocess.Popen(
        command, cwd=home, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT
    ) as job:
        try:
            return job.wait(limit) in (0, 5)  # 5: nothing was left to run
        except subprocess.TimeoutExpired:
            job.kill()
            return False


class Fork:
    """A process that has the tests ready and tries a fault in a fork of itself (see swapping.py)."""

    def __init__(self):
        left_out = [f"--ignore={file}" for file in LEFT_OUT]
        command = [sys.executable, "-m", "pytest", "-p", "swapping", "-p", "no:cacheprovider", *left_out]
        environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL, "text": True}
        self.process = subprocess.Popen(command, cwd=ROOT, env=environment, **pipes)
        self.sound = {}

    def try_fault(self, file, fault, seconds):
        """What became of a fault: "caught", "survived", "not run" by any test of the map, or "at import"."""
        _, (begin, end), text = fault
        chosen, expected = quickest(tests_by_line(file).get(fault[0], set()), seconds, room_of(file))
        if not any("::" in name for name in chosen):
            return "at import" if chosen else "not run"
        put = {"file": file, "begin": begin, "end": end, "text": text}
        verdict, test = self._ask(put, chosen, 30 + int(5 * expected))
        if "::" in test and test not in self.sound:
            self.sound[test] = self._ask(None, [test], 120)[0] == "survived"
        return verdict if self.sound.get(test, True) else "at import"

    def _ask(self, fault, tests, limit):
        print(json.dumps({"fault": fault, "tests": tests, "limit": limit}), file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def work(jobs, again=True):
    """Try (file, fault) two at a time, then what survived once more with more tests; say which, and count."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    seconds = json.loads((MAP / "seconds.json").read_text())
    skip = shutil.ignore_patterns(".venv", ".git", ".mypy_cache", ".ruff_cache", MAP.name)
    homes = queue.SimpleQueue()

    def in_a_home(attempt, file, fault):
        home, start = homes.get(), time.time()
        verdict = attempt(home, file, fault)
        homes.put(home)
        if verdict != "caught":
            print(f"{verdict} ({time.time() - start:.0f} s): {shown(file, fault)}", flush=True)
        return verdict

    def first_look(home, file, fault):
        folder, fork = home
        verdict = fork.try_fault(file, fault, seconds)
        return try_fault(folder, file, fault, seconds) if verdict == "at import" else verdict

    def second_look(home, file, fault):
        return look_again(home[0], file, fault)

    with tempfile.TemporaryDirectory() as room, concurrent.futures.ThreadPoolExecutor(2) as pool:
        both = [(Path(shutil.copytree(ROOT, Path(room) / name, ignore=skip)), Fork()) for name in "ab"]
        for home in both:
            homes.put(home)
        first = list(pool.map(lambda job: in_a_home(first_look, *job), jobs))
        for _, fork in both:
            fork.close()
        print(dict(Counter(first)), flush=True)
        left = [job for job, verdict in zip(jobs, first, strict=True) if verdict != "caught"]
        if again:
            print("those not caught again:", flush=True)
            print(dict(Counter(pool.map(lambda job: in_a_home(second_look, *job), left))))


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["map"]:
            draw_map()
        case ["run", count, seed]:
            work(drawn(int(count), int(seed)))
        case ["hunt", count, seed, *places]:
            work(drawn(int(count), int(seed), places or ["geomkin"]), again=False)
        case ["one", place]:
            file, line = place.split(":")
            work([(file, fault) for fault in faults(ROOT / file, int(line))])
        case _:
            print(__doc__)
