"""A plugin of pytest that tries faults without starting Python anew for each: half a second a fault instead of five.

It collects the tests, imports all of geomkin, and then answers the lines of its standard input. A line is a fault and
the names of tests; in a fork of the process the functions of the changed source get their new code, the tests run until
one fails, and the answer is "caught" with that test's name, or "survived". A fault in what is run while a module is
imported (a constant, a default, a class) cannot be put in that way: "at import". A line without a fault is the same
without one, so that a test that fails in a fork for another reason is found out.
"""

import gc
import importlib
import json
import os
import pkgutil
import resource
import signal
import types
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent.parent
# Taken before pytest puts its own in their place; what pytest itself prints goes with the errors.
ASKED, ANSWERS = os.fdopen(os.dup(0)), os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
# A fault that asks for more than this fails instead of taking the machine down.
MEMORY = 6 << 30


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session):
    import geomkin

    for module in pkgutil.walk_packages(geomkin.__path__, "geomkin."):
        if not module.name.endswith("__main__"):
            try:
                importlib.import_module(module.name)
            except ImportError:
                continue  # needs a library that is not there: no test runs it either
    gc.unfreeze()  # conftest.py freezes all objects, which are not listed then
    everything = gc.get_objects()
    functions = [one for one in everything if isinstance(one, types.FunctionType)]
    kept = [one for one in everything if type(one).__name__ == "_lru_cache_wrapper"]
    items = {item.nodeid: item for item in session.items}
    gc.freeze()  # else a fork copies what the collector looks through
    for line in ASKED:
        asked = json.loads(line)
        swaps = _swaps(functions, **asked["fault"]) if asked["fault"] else []
        if asked["fault"] and not swaps:
            answer = "at import", ""
        else:
            tests = [items[name] for name in asked["tests"] if name in items]
            answer = _in_a_fork(session, tests, swaps, kept, asked["limit"])
        print(json.dumps(answer), file=ANSWERS, flush=True)
    return True


def _swaps(functions, file, begin, end, text):
    """(function, its new code) for each function of the source that the fault changes."""
    path = ROOT / file
    raw = path.read_bytes()
    before, after = (
        list(_codes(compile(source, path, "exec", dont_inherit=True)))
        for source in (raw, raw[:begin] + text.encode() + raw[end:])
    )
    if len(before) != len(after):
        return []
    changed = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    mine = [one for one in functions if one.__code__.co_filename == str(path)]
    return [(one, new) for one in mine for old, new in changed if one.__code__ == old]


def _codes(code):
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _codes(constant)


def _in_a_fork(session, tests, swaps, kept, limit):
    reader, writer = os.pipe()
    process = os.fork()
    if not process:
        os.close(reader)
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(limit)
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nothing, stream)
        try:
            _run(session, tests, swaps, kept, writer)
        except BaseException as end:
            _end(writer, type(end).__name__)
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as answer:
        test = answer.read()
    _, status = os.waitpid(process, 0)
    return ("survived", "") if not status else ("caught", test or "by its time or its end")


def _run(session, tests, swaps, kept, writer):
    class Watch:
        def pytest_runtest_logreport(self, report):
            if report.failed:
                _end(writer, report.nodeid)

    session.config.pluginmanager.register(Watch())
    for function, code in swaps:
        function.__code__ = code
    for one in kept:
        one.cache_clear()
    for item, then in zip(tests, [*tests[1:], None], strict=True):
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=then)


def _end(writer, text):
    os.write(writer, text.encode())
    os._exit(1)
