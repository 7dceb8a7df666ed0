"""An animated SVG of the moving mechanism without a script, for READMEs, slides and e-mails."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..plane.vec import Mask, Real, Whole, rounded
from .job import Job
from .picture import SCALE_DIGITS, TURN_DIGITS, Item, items, page_box, style, svg_document, transform
from .still import Still, frame_at, kept_frames
from .svg_path import decimal

# Duration of one pass, s, about that of the page. The eye cannot follow a faster turn.
SECONDS = 5
# Largest position error between two key frames, in pixels of the picture. With half of it files are 1.5 times as large;
# with twice as much, pins visibly leave their holes.
MOST_ERROR = 0.3
# Number of frames from which the bounds of the motion are computed.
BOUND_FRAMES = 72


def animation(job: Job) -> bytes:
    """The picture. A full turn repeats without a jump; any other motion goes back and forth.

    It is static, like the assembly, for readers who prefer reduced motion and in programs without animation. If the
    motion has gaps, its longest run is shown.
    """
    scene = job.scene
    frames, is_cyclic = _run(np.asarray(scene.assembled), scene.cyclic)
    bound_frames = frames[np.unique(np.rint(np.linspace(0, len(frames) - 1, BOUND_FRAMES + 1)).astype(np.intp))]
    first = frame_at(scene, job.assembly_at)
    still = Still(scene, np.concatenate([[first], bound_frames]))
    moving = MovingItems(still, frames, np.asarray(scene.time, dtype=float)[frames])
    drawn = "".join(moving.drawn())
    repetition = "infinite" if is_cyclic else "infinite alternate"
    css = (
        f"{style(still, drawn)}@media(prefers-reduced-motion:no-preference){{"
        f".move{{animation:{SECONDS}s linear {repetition}}}{moving.rules()}}}{moving.keyframes()}"
    )
    body = [f'<g transform="scale(1 -1)">{drawn}</g>']
    return svg_document(still, page_box(still), job.name, job.about or "A mechanism, moving.", css, body)


def _run(assembled: Mask, cyclic: bool) -> tuple[Whole, bool]:
    """Frames of the longest run in which the mechanism is assembled, and whether the motion is cyclic."""
    runs = np.split(np.arange(len(assembled)), np.flatnonzero(np.diff(assembled)) + 1)
    run = max((run for run in runs if assembled[run[0]]), key=len, default=np.zeros(0, dtype=np.intp))
    if len(run) < 2:
        raise DesignError("write", "names an animation, and nothing moves", "omit it", "conflict")
    return run[kept_frames(len(run))], cyclic and bool(assembled.all())


@record(eq=False)
class MovingItems:
    """Items of a still picture and their motions; items that move alike share a motion.

    `frames` are those shown, `time` is their time, s; `motions` maps the text of key frames to a name.
    """

    still: Still
    frames: Whole
    time: Real
    motions: dict[str, str] = field(default_factory=dict)

    def drawn(self) -> Iterator[str]:
        """All items, each in a group that moves."""
        still = self.still
        bodies: list[Item] = []
        for item in items(still):
            drawn = item.drawn
            if item.body:
                bodies.append(item)
            if len(item.origin) == 1:
                yield drawn
                continue
            if not np.isfinite(item.origin[self.frames]).any():
                continue
            if not item.body and not self._is_at_rest(item) and (carrier := self._carrier(item, bodies)):
                item, in_its_frame = carrier
                drawn = f"<g{in_its_frame}>{drawn}</g>"
            moves = "" if self._is_at_rest(item) else f' class="move {self._motion(item)}"'
            yield f"<g{moves}{transform(still, item, still.frame)}>{drawn}</g>"

    def rules(self) -> str:
        """The style rules that assign motions to classes."""
        return "".join(f".{name}{{animation-name:{name}}}" for name in self.motions.values())

    def keyframes(self) -> str:
        """The style rules of the motions."""
        return "".join(f"@keyframes {name}{{{text}}}" for text, name in self.motions.items())

    def _is_at_rest(self, item: Item) -> bool:
        rows = [item.origin, item.direction, item.scale]
        near = 1e-9 * self.still.size
        return all(row is None or np.abs(row[self.frames] - row[self.still.frame]).max() < near for row in rows)

    def _carrier(self, item: Item, bodies: list[Item]) -> tuple[Item, str] | None:
        """The body to which a mark is fixed, and the mark's transform in its frame; None if there is no such body."""
        if item.scale is not None:
            return None
        for body in bodies:
            if body.direction is None:
                continue
            back = np.conj(body.direction)
            place = back * (item.origin - body.origin)
            turn = None if item.direction is None else back * item.direction
            local = Item("", place, turn)
            if np.isfinite(place[self.frames]).all() and self._is_at_rest(local):
                return body, transform(self.still, local, self.still.frame)
        return None

    def _motion(self, item: Item) -> str:
        """The name of an item's motion."""
        text = self._keyframes_text(item)
        return self.motions.setdefault(text, f"m{len(self.motions)}")

    def _keyframes_text(self, item: Item) -> str:
        place = item.origin[self.frames]
        turn = np.zeros(len(place)) if item.direction is None else np.angle(item.direction[self.frames])
        size = np.ones(len(place)) if item.scale is None else item.scale[self.frames]
        known = np.isfinite(place) & np.isfinite(turn) & np.isfinite(size)
        share = (self.time - self.time[0]) / (self.time[-1] - self.time[0])
        has_gaps = not known.all()
        rules: dict[int, str] = {}
        for run in np.split(np.arange(len(place)), np.flatnonzero(np.diff(known)) + 1):
            if not known[run[0]]:
                continue
            angle = np.unwrap(turn[run])
            rows = np.array([place[run].real, place[run].imag, item.radius * angle, item.radius * size[run]])
            keys = key_frames(share[run], rows, MOST_ERROR * self.still.pixel)
            poses = [self._pose(item, place[run][k], float(angle[k]), float(size[run][k])) for k in keys]
            rules |= {int(run[k]): f"{pose}{';opacity:1' if has_gaps else ''}" for k, pose in zip(keys, poses)}
            # Next to a gap the item fades within a frame.
            if run[0] > 0:
                rules[int(run[0]) - 1] = f"{poses[0]};opacity:0"
            if run[-1] < len(place) - 1:
                rules[int(run[-1]) + 1] = f"{poses[-1]};opacity:0"
        # Without a rule at 0 and 100 % browsers use the static position there.
        for end, nearest in ((0, min(rules)), (len(place) - 1, max(rules))):
            rules.setdefault(end, rules[nearest])
        return "".join(f"{decimal(100 * float(share[k]), 2)}%{{{rules[k]}}}" for k in sorted(rules))

    def _pose(self, item: Item, place: complex, angle: float, size: float) -> str:
        digits = self.still.digits
        z = rounded(complex(place), digits).item()
        text = f"transform:translate({decimal(z.real, digits)}px,{decimal(z.imag, digits)}px)"
        if item.direction is not None:
            turn = rounded(np.degrees(angle), TURN_DIGITS).item()
            text += f"rotate({decimal(turn, TURN_DIGITS)}deg)"
        return text + (
            f"scale({decimal(rounded(size, SCALE_DIGITS).item(), SCALE_DIGITS)})" if item.scale is not None else ""
        )


def key_frames(share: Real, rows: Real, tolerance: float) -> list[int]:
    """Few of the frames (n,) between which linear interpolation in time keeps the rows (rows, n) within a tolerance.

    Greedy: each frame is as far from the previous one as possible. Both ends are included. Derived here.
    """
    keys, last = [0], len(share) - 1
    while keys[-1] < last:
        start, good, bad = keys[-1], keys[-1] + 1, last + 1
        step = 1
        while good + step < bad and _is_near(share, rows, start, good + step, tolerance):
            good, step = good + step, 2 * step
        bad = min(bad, good + step)
        while bad - good > 1:
            middle = (good + bad) // 2
            good, bad = (middle, bad) if _is_near(share, rows, start, middle, tolerance) else (good, middle)
        keys.append(good)
    return keys


def _is_near(share: Real, rows: Real, start: int, end: int, tolerance: float) -> bool:
    inside = slice(start, end + 1)
    along = (share[inside] - share[start]) / (share[end] - share[start])
    straight = rows[:, start, None] + along * (rows[:, end, None] - rows[:, start, None])
    return bool(np.sqrt(((rows[:, inside] - straight) ** 2).sum(axis=0)).max() <= tolerance)
