"""Every number that a recipe may give, at its ends: `python -m tests.hostile.extremes [KIND...]`.

Of each kind's template one number at a time is set to its declared least and greatest, to what is tiny and to
what is huge. Each recipe is run in a process of its own with 2 GB of memory, 20 s, and warnings as errors. Told
is every one that ends otherwise than made, or refused in lines that name a key; exit 1 where there is any.
`pytest -m campaign` tries a sample of them.
"""

import os
import random
import re
import resource
import select
import signal
import sys
import tempfile
import warnings
from pathlib import Path

from tests.texts import template_of

from .mutations import options

# Seconds are of the processor, whatever else the machine does.
MEMORY, SECONDS = 2 << 30, 20
TINY_AND_HUGE = ("0", "5e-324", "1e-300", "1e-12", "1e-7", "1e9", "1e300")
LINE = re.compile(r"^(?:# )?(\w+) +=\s*([^#]*?)\s*# (.*)$")
LIMIT = re.compile(r"(?:at least|above|at most|below) (-?[\d.]+(?:e[+-]?\d+)?)")


def cases(text):
    """(key, value, text) for every number and point of a template."""
    lines, table, rows = text.splitlines(), "", 0
    for k, line in enumerate(lines):
        if line.startswith("["):
            table = line.split("#")[0].strip(" []")
            rows += line.startswith("[[")
            table += f"[{rows}]" if line.startswith("[[") else ""
        found = LINE.match(line)
        if not found:
            continue
        key, shown, note = found.groups()
        if "[x, y]" in note:
            values = ["[1e9, -1e9]", "[5e-324, 0]", "[1e-300, 1e-300]", "[1e-7, 0]"]
        elif LIMIT.search(note):
            values = [*LIMIT.findall(note), *TINY_AND_HUGE]
            values = list({float(value): value for value in values}.values())
            if re.fullmatch(r"\d+", shown) and key in WHOLE:
                values = LIMIT.findall(note)
        else:
            continue
        for value in dict.fromkeys(values):
            yield f"{table}.{key}", value, "\n".join([*lines[:k], f"{key} = {value}", *lines[k + 1 :]]) + "\n"


WHOLE = {"teeth", "pins", "rows", "columns", "planets", "count", "spokes", "decimals", "degree", "intervals"}


def attempt(text, folder):
    """What became of a recipe, "" or how it failed, and the seconds it took."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read)
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        warnings.simplefilter("error")
        os.write(write, _made(text, folder).encode("utf-8", "replace")[:4000] or b"ok")
        os._exit(0)
    os.close(write)
    ready = select.select([read], [], [], 10 * SECONDS)[0]
    reported = os.read(read, 4000).decode("utf-8", "replace") if ready else ""
    os.close(read)
    if not ready:
        os.kill(child, signal.SIGKILL)
    _, status, used = os.wait4(child, 0)
    if not reported:
        reported = f"more than {SECONDS} s" if not ready or used.ru_utime > SECONDS - 1 else f"died: {status}"
    reported = "" if reported == "ok" else reported
    return reported, used.ru_utime + used.ru_stime


def _made(text, folder):
    """What is odd about how a recipe ended, "" where nothing is."""
    import geomkin as gk

    file = Path(folder) / "r.toml"
    file.write_text(text)
    try:
        gk.make(file, folder)
    except gk.RecipeError as error:
        bad = [line for line in str(error).splitlines() if not line.isprintable() or line.count(": ") < 2]
        return f"odd message: {bad[0]}" if bad else ""
    except MemoryError:
        return f"more than {MEMORY >> 20} MB"
    except BaseException as error:
        return f"{type(error).__name__}: {error}"
    return ""


def every_case(kinds):
    """(kind, --with, key, value, text) of every template of the kinds; what several of one kind's share comes once."""

    for name in kinds:
        seen = set()
        for wish in options(name):
            for key, value, text in cases(template_of(name, wish)):
                tables = " ".join(wish) if "program" in key or "follower" in key else ""
                if (tables, key, value) not in seen:
                    seen.add((tables, key, value))
                    yield name, " ".join(wish), key, value, text


def numbers_at_their_ends(count, seed):
    """(name, text) of so many recipes drawn from all kinds' alike, half of them with a second number at its end."""
    from geomkin.recipe.kinds import KINDS

    rng, found = random.Random(seed), []
    by_kind = {kind: list(every_case([kind])) for kind in KINDS}
    for number in range(count):
        kind, wish, key, value, text = rng.choice(by_kind[list(KINDS)[number % len(KINDS)]])
        name = f"{kind} {wish}: {key} = {value}"
        if rng.random() < 0.5:
            key, value, text = rng.choice(list(cases(text)))
            name += f", {key} = {value}"
        found.append((name, text))
    return found


def main(arguments):
    from geomkin.recipe.kinds import KINDS

    failures = tried = 0
    with tempfile.TemporaryDirectory() as folder:
        for kind in arguments or KINDS:
            _made(template_of(kind), folder)  # loads what every child needs
        for kind, wish, key, value, text in every_case(arguments or KINDS):
            reported, seconds = attempt(text, folder)
            tried += 1
            failures += bool(reported)
            if reported or seconds > SECONDS / 2:
                print(f"{kind} {wish}: {key} = {value}: {reported or 'made'} ({seconds:.1f} s)", flush=True)
    print(f"{tried} recipes, {failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
