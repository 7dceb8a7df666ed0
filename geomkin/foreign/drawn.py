"""A linkage as it was drawn in another program, joint by joint, and its recipe."""

from __future__ import annotations

import cmath
import itertools
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn

from ..core.errors import DesignError, Problem, ProblemId, RecipeError, printable
from ..linkage.moving import move
from ..recipe.load import parse
from ..recipe.toml import toml_key, toml_value

# Most joints and links of a file; a linkage of geomkin has at most 15 moving plates.
MOST = 200
# Largest coordinate, mm.
FARTHEST = 1e6
PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,29}")


@dataclass(frozen=True)
class DrawnSlot:
    """A pin that runs along a line of a guide.

    pin: a joint. guide: joints of the body that guides it, none if that is the frame. through, direction: the line.
    """

    pin: str
    guide: tuple[str, ...]
    through: complex
    direction: complex


@dataclass(frozen=True)
class Drawn:
    """A linkage as it was drawn.

    program: that wrote the file. joints: their positions, mm, by id. fixed: those on the frame. links: name and joints
    of each. driver: the fixed joint about which the driving link turns. speed_rpm: negative if clockwise. turn_deg: how
    far it turns. scale: of the recipe. notes: what was assumed or left out.
    """

    program: str
    joints: Mapping[str, complex]
    fixed: frozenset[str]
    links: tuple[tuple[str, tuple[str, ...]], ...]
    driver: str
    speed_rpm: float = 60.0
    turn_deg: float = 360.0
    slots: tuple[DrawnSlot, ...] = ()
    scale: float = 1.0
    notes: tuple[str, ...] = field(default=())


def refuse(file: str, key: str, problem: str, remedy: str, id: ProblemId = "unknown-kind") -> NoReturn:
    """Raise RecipeError for a file that cannot be taken over."""
    raise RecipeError(file, [Problem(printable(key), problem, remedy, id)])


def number(file: str, key: str, value: object) -> float:
    """A coordinate or another number of the file; RecipeError if it is none, or too large."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= FARTHEST:
        refuse(file, key, "it is not a number up to 1,000,000", "save the file again", "out-of-range")
    return float(value)


def recipe_of(drawn: Drawn, file: str) -> str:
    """The text of a recipe of kind `linkage`; RecipeError if the linkage cannot move as one."""
    bodies = rigid_bodies(drawn)
    ground = bodies[0][1]
    movers = [k for k, (_, joints) in enumerate(bodies) if k and drawn.driver in joints]
    if drawn.driver not in ground or len(movers) != 1:
        problem = f"the driver at joint {printable(drawn.driver)} turns {len(movers)} links about the frame"
        refuse(file, "driver", problem, "let one link turn about a fixed joint", "conflict")
    (mover,) = movers
    names = plain_names([*drawn.joints, *map(key_of, range(1, len(bodies)))], [name for name, _ in bodies[1:]])
    names[key_of(0)] = "ground"
    at = {joint: place - drawn.joints[drawn.driver] for joint, place in drawn.joints.items()}
    frames = [(0j, 1 + 0j)]
    for k, (name, joints) in enumerate(bodies[1:], 1):
        frames.append(frame_of([drawn.driver, *joints] if k == mover else joints, at))
        if frames[-1][1] == 0:
            refuse(file, name, "its joints are at one place", "draw it with a length", "out-of-range")
    lines = [f"# From a file of {drawn.program}.", *(f"# {printable(note, 200)}" for note in drawn.notes)]
    lines += ['kind = "linkage"', *([f"scale = {toml_value(drawn.scale)}"] if drawn.scale != 1 else [])]
    lines += ["", "[linkage]", f"driver = {toml_value(names[key_of(mover)])}", "", "[linkage.bodies]"]
    for k, (_, joints) in enumerate(bodies):
        points = {names[joint]: local(at[joint], frames[k]) for joint in joints}
        lines.append(f"{toml_key(names[key_of(k)])} = {toml_value(points)}")
    for slot in drawn.slots:
        lines += slot_lines(file, slot, bodies, names, frames, drawn.joints[drawn.driver])
    joined = [joint for joint in at if sum(joint in joints for _, joints in bodies) > 1]
    pins = [joint for joint in dict.fromkeys([*joined, *(slot.pin for slot in drawn.slots)]) if joint not in ground]
    if pins:
        # The positions of the pins in the drawing determine the assembly mode.
        lines += ["", "[branches]", *(f"{toml_key(names[pin])} = {toml_value(rounded(at[pin]))}" for pin in pins)]
    start = math.degrees(cmath.phase(frames[mover][1]))
    end = start + math.copysign(drawn.turn_deg, drawn.speed_rpm)
    lines += ["", "[drive]", f"speed_rpm = {toml_value(short(drawn.speed_rpm))}"]
    lines += [f"start_deg = {toml_value(short(start))}", f"end_deg = {toml_value(short(end))}", ""]
    text = "\n".join(lines)
    check_drawing(parse(text, file), file)
    return text


def key_of(body: int) -> str:
    """What a body is called among the ids of joints, none of which has a zero byte."""
    return f"\0{body}"


def frame_of(joints: Sequence[str], at: Mapping[str, complex]) -> tuple[complex, complex]:
    """Origin and direction of a body's frame: its first joint, and the next that is elsewhere; 0 if none is."""
    origin = at[joints[0]]
    arm = next((at[joint] - origin for joint in joints if abs(at[joint] - origin) > 1e-6), 0j)
    return origin, arm / abs(arm) if arm else 0j


def check_drawing(recipe: Any, file: str) -> None:
    """Raise RecipeError if the linkage cannot be moved, or not put together where it was drawn."""
    try:
        motion = move(recipe.design, [math.radians(recipe.drive.start_deg)], dict(recipe.branches))
    except DesignError as error:
        raise RecipeError(file, [error.as_problem]) from None
    if not motion.assembled.all():
        refuse(
            file, "links", "its links do not meet where they were drawn", "save it at its first position", "conflict"
        )


def rigid_bodies(drawn: Drawn) -> list[tuple[str, tuple[str, ...]]]:
    """Name and joints of each body, the frame first; links with two common joints are one body."""
    bodies = [("ground", dict.fromkeys(joint for joint in drawn.joints if joint in drawn.fixed))]
    bodies += [(name, dict.fromkeys(joints)) for name, joints in drawn.links]

    def overlap() -> tuple[int, int] | None:
        pairs = itertools.combinations(range(len(bodies)), 2)
        return next(((a, b) for a, b in pairs if len(bodies[a][1].keys() & bodies[b][1]) > 1), None)

    while pair := overlap():
        bodies[pair[0]][1].update(bodies.pop(pair[1])[1])
    return [(name, tuple(joints)) for k, (name, joints) in enumerate(bodies) if not k or len(joints) > 1]


def slot_lines(
    file: str,
    slot: DrawnSlot,
    bodies: list[tuple[str, tuple[str, ...]]],
    names: Mapping[str, str],
    frames: Sequence[tuple[complex, complex]],
    origin: complex,
) -> list[str]:
    """The table of a slot."""
    guides = [k for k, (_, joints) in enumerate(bodies) if all(joint in joints for joint in slot.guide)]
    holders = [k for k, (_, joints) in enumerate(bodies) if slot.pin in joints and k not in guides[:1]]
    if not guides or not holders:
        problem = f"the slide of joint {printable(slot.pin)} is between no two bodies"
        refuse(file, slot.pin, problem, "let it slide between two joints of another link", "conflict")
    frame = frames[guides[0]]
    return [
        "",
        "[[linkage.slots]]",
        f"name = {toml_value(f'slot_{names[slot.pin]}')}",
        f"body = {toml_value(names[key_of(holders[0])])}",
        f"pin = {toml_value(names[slot.pin])}",
        f"along = {toml_value(names[key_of(guides[0])])}",
        f"through = {toml_value(local(slot.through - origin, frame))}",
        f"direction_deg = {toml_value(round(math.degrees(cmath.phase(slot.direction / frame[1])), 9) + 0.0)}",
    ]


def plain_names(ids: Iterable[str], links: Iterable[str]) -> dict[str, str]:
    """Plain names of joints and, in their order, of links; ids that are plain names stay."""
    given, taken = iter(links), {"ground"}
    names = {}
    for id in ids:
        sort, wanted = ("link", next(given)) if id.startswith("\0") else ("P", id)
        name = wanted if PLAIN.fullmatch(wanted) else sort + wanted * (wanted.isdecimal() and len(wanted) < 9)
        numbered = (f"{name}_{k}" for k in itertools.count(2))
        unique = name if name.casefold() not in taken else next(n for n in numbered if n.casefold() not in taken)
        taken.add(unique.casefold())
        names[id] = unique
    return names


def local(place: complex, frame: tuple[complex, complex]) -> list[float]:
    """A place in the frame of a body."""
    return rounded((place - frame[0]) / frame[1])


def rounded(place: complex) -> list[float]:
    """A point as a recipe has it: to a millionth of a mm."""
    return [round(place.real, 6) + 0.0, round(place.imag, 6) + 0.0]


def short(value: float) -> float:
    """A number to nine digits."""
    return float(f"{value:.9g}") + 0.0
