"""SVG of the assembly for viewing: at one position, step by step, and as an animation without a script."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field, replace
from functools import cached_property
from html import escape
from textwrap import wrap

import numpy as np

from ..core.errors import DesignError, harmless
from ..core.records import record
from ..core.units import LengthUnit
from ..model.scene import Scene, SceneBody, layer_name
from ..plane.vec import Mask, Real, Whole, box_of, rounded
from .job import Job
from .picture import MARGIN, SCALE_DIGITS, TURN_DIGITS, Item, items, page_box, style, svg_document, transform
from .still import LETTER, NARROW, PIXELS, Name, Still, frame_at, half_size, kept_frames, place_labels, some_points
from .svg_path import decimal
from .text import number, with_unit

# Height in pixels of the strip below the picture for the scale.
BELOW = 22.0
# Largest width of the scale as a share of the picture.
SCALE = 0.3


def assembly_picture(job: Job) -> bytes:
    """The picture; its title names the assembly and the driver position."""
    frame = frame_at(job.scene, job.assembly_at)
    still = Still(job.scene, np.array([frame]))
    drive = job.scene.drive
    position = f"{drive.id.replace('_', ' ')} {with_unit(float(np.asarray(drive.values)[frame]), drive.unit)}"
    names = place_labels(still)
    box = _wide_enough(page_box(still, names, BELOW), f"{position} and a length", still)
    body = [
        '<g transform="scale(1 -1)">',
        *_placed(still),
        "</g>",
        *_names(still, names),
        _scale_bar(still, box, position, job.unit),
    ]
    css = style(still, "".join(body))
    return svg_document(still, box, f"{job.name}, assembled", f"The parts in place at {position}.", css, body, job.unit)


def _placed(still: Still) -> Iterator[str]:
    for item in items(still):
        place = item.origin[still.frame] if len(item.origin) > 1 else item.origin[0]
        if np.isfinite(place):
            yield f"<g{transform(still, item, still.frame)}>{item.drawn}</g>"


def _names(still: Still, names: Sequence[Name]) -> Iterator[str]:
    digits = still.digits
    for name in names:
        place = rounded(name.place - 0.35j * LETTER * still.pixel, digits).item()
        role = name.role or "of"
        yield (
            f'<text class="{role}" x="{decimal(place.real, digits)}" y="{decimal(-place.imag, digits)}">'
            f"{escape(harmless(name.text))}</text>"
        )


def _wide_enough(box: tuple[complex, complex], words: str, still: Still) -> tuple[complex, complex]:
    """The box, widened if the text next to the scale would not fit."""
    low, high = box
    width = 2 * half_size(words, LETTER * still.pixel).real + 2 * MARGIN * still.pixel
    widening = max(0.0, width - (1 - SCALE) * (high - low).real) / (1 - SCALE)
    return low, rounded(high + widening, still.digits).item()


def _scale_bar(still: Still, box: tuple[complex, complex], at: str, unit: LengthUnit) -> str:
    """A length for measuring, and the driver position."""
    px, digits = still.pixel, still.digits
    low, high = box
    most = unit.of(SCALE * (high - low).real)
    power = 10.0 ** np.floor(np.log10(most))
    shown = float(next(step for step in (5, 2, 1) if step * power <= most) * power)
    length = shown * unit.mm
    x, y = low.real + MARGIN * px, -low.imag - 12 * px
    left, right, middle, top, bottom = (decimal(v, digits) for v in (x, x + length, y, y - 4 * px, y + 4 * px))
    text = f"{number(shown)} {unit.name}, {at}"
    return (
        f'<path d="M{left} {top}V{bottom}M{left} {middle}H{right}M{right} {top}V{bottom}"/>'
        f'<text class="scale" x="{decimal(x + length + 6 * px, digits)}" y="{decimal(y + 4 * px, digits)}">'
        f"{escape(harmless(text))}</text>"
    )


# Number of pictures in a row.
COLUMNS = 4
# Height of a line of the heading above a picture, in pixels, and the number of lines reserved.
LINE, LINES = 15.0, 2
# Opacity of parts that are already in place.
FAINT = 0.25


@record(eq=False)
class LayerPicture:
    """A picture of the parts up to a layer.

    Parameters
    ----------
    still : Still
        The bodies that are assembled together, one for each part.
    layer : int
        The layer whose parts are to be added.
    heading : str
        The layer and its parts.
    """

    still: Still
    layer: int
    heading: str

    @cached_property
    def texts(self) -> tuple[tuple[str, complex], ...]:
        """Names of the parts of the layer and letters of their holes, each with the place of its middle, mm."""
        k, still = self.still.frame, self.still
        shown = tuple(
            replace(body, named=body.layer == self.layer) for body in still.bodies if body.layer <= self.layer
        )
        names = place_labels(Still(replace(still.scene, bodies=shown), still.frames))
        texts = [(name.text, name.place) for name in names]
        for body in (body for body in still.bodies if body.layer == self.layer):
            for part in body.parts:
                for letter, hole in zip(part.hole_names, part.holes):
                    low, high = box_of(some_points(hole))
                    texts.append((letter, complex(body.origin[k] + body.direction[k] * (high + low) / 2)))
        return tuple(texts)


def layer_pictures(job: Job) -> list[LayerPicture]:
    """A picture of each layer with parts, from the lowest up, of each unit that is assembled by itself."""
    scene = job.scene
    frames = np.array([frame_at(scene, job.assembly_at)])
    return [
        LayerPicture(still, layer, heading)
        for title, bodies in (scene.units or {"": scene.bodies}).items()
        for still in [Still(_parts_alone(scene, bodies), frames)]
        for layer, heading in _layers(still, title)
    ]


def steps_picture(job: Job) -> bytes:
    """The pictures of all layers in rows; they have one scale."""
    scene, pictures = job.scene, layer_pictures(job)
    stills = [picture.still for picture in pictures] or [Still(scene, np.array([frame_at(scene, job.assembly_at)]))]
    largest = max(stills, key=lambda still: still.pixel)
    px, digits = largest.pixel, largest.digits
    low, high = box_of(np.array([still.bounds for still in stills]))
    size = high - low + px * complex(2 * MARGIN, 2 * MARGIN + LINES * LINE)
    body = []
    for place, picture in enumerate(pictures):
        row, column = divmod(place, COLUMNS)
        corner = rounded(complex(column * size.real, row * size.imag), digits).item()
        body += [
            f'<g transform="translate({decimal(corner.real, digits)} {decimal(corner.imag, digits)})">',
            *_heading(picture.heading, low.real, -high.imag - (MARGIN + (LINES - 1) * LINE) * px, largest),
            *_layer(picture),
            "</g>",
        ]
    columns, rows = min(COLUMNS, len(pictures) or 1), -(-len(pictures) // COLUMNS) or 1
    left, top = low.real - MARGIN * px, high.imag + (MARGIN + LINES * LINE) * px
    box = complex(left, top - rows * size.imag), complex(left + columns * size.real, top)
    box = rounded(np.array(box), digits).tolist()
    about = "Layers from the lowest up; the parts to add are coloured, and letters mark their holes."
    css = style(largest, "".join(body))
    return svg_document(largest, tuple(box), f"{job.name}, assembly", about, css, body, job.unit)


def _parts_alone(scene: Scene, bodies: tuple[SceneBody, ...]) -> Scene:
    """A scene of some bodies only, each with the name of its part."""
    named = (replace(body, name=part.name, parts=(part,), named=True) for body in bodies for part in body.parts)
    return replace(scene, bodies=tuple(named), marks=(), curves=(), regions=(), others={})


def _layers(still: Still, title: str) -> Iterator[tuple[int, str]]:
    """The layers with parts, and the heading of each."""
    for layer in sorted({body.layer for body in still.bodies}):
        names = ", ".join(body.name for body in still.bodies if body.layer == layer)
        yield layer, f"{title}{', ' if title else ''}{layer_name(layer)}: {names}"


def _heading(words: str, x: float, y: float, still: Still) -> Iterator[str]:
    px, digits = still.pixel, still.digits
    lines = wrap(words, int(PIXELS / (NARROW * LETTER)), max_lines=LINES)
    for k, line in enumerate(lines):
        place = decimal(rounded(x, digits).item(), digits), decimal(rounded(y + k * LINE * px, digits).item(), digits)
        yield f'<text class="scale" x="{place[0]}" y="{place[1]}">{escape(harmless(line))}</text>'


def _layer(picture: LayerPicture) -> Iterator[str]:
    """The parts up to a layer; those of the layer with their names and the letters of their holes."""
    still, layer = picture.still, picture.layer
    digits, tall = still.digits, LETTER * still.pixel
    layers = {body.name: body.layer for body in still.bodies}
    yield '<g transform="scale(1 -1)">'
    for item in items(still):
        if layers[item.body] <= layer:
            faint = f' opacity="{FAINT}"' if layers[item.body] < layer else ""
            yield f"<g{transform(still, item, still.frame)}{faint}>{item.drawn}</g>"
    yield "</g>"
    for words, place in picture.texts:
        at = rounded(place - 0.35j * tall, digits).item()
        yield f'<text x="{decimal(at.real, digits)}" y="{decimal(-at.imag, digits)}">{escape(harmless(words))}</text>'


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
    return svg_document(still, page_box(still), job.name, job.about or "A mechanism, moving.", css, body, job.unit)


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
