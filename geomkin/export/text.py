"""Texts of drawings and pages: title blocks, numbers with units, HTML; and letters of single strokes, to engrave."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache
from html import escape
from math import isfinite
from unicodedata import east_asian_width

import numpy as np

from ..core.errors import DesignError, harmless, shown
from ..core.fields import entry
from ..core.names import is_letter
from ..core.records import record
from ..model.part import Part
from ..plane import measure as measure
from ..plane import region as region
from ..plane.flatten import flatten
from ..plane.primitives import Polyline
from ..plane.vec import Complex, box_of, rounded

# Significant digits of a number in a text.
DIGITS = 4
# Most letters of an entry; more make the title wider than most parts.
LONGEST = 60
# Characters of the fonts of CAD programs, besides letters, digits and ASCII.
SIGNS = "°±µ²³Øøß§"
# Characters that CAD programs read as the start of a code.
CODES = "\\^"


@record(checked=True)
class Title:
    """Entries of the title block of a drawing; omitted entries are not drawn.

    Parameters
    ----------
    name : str
        Subject of the drawing; the recipe's name by default.
    number, revision : str
        Number and revision of the drawing.
    material : str
        Material of the parts.
    general_tolerance : str
        Tolerance of sizes without their own; of gears, their accuracy class.
    drawn_by : str
        Name of the draughtsman.
    date : str
        Date of the drawing, as any text.

    Raises
    ------
    DesignError
        If an entry has more than 60 letters, or characters that the fonts of CAD programs lack.
    """

    name: str = entry("subject of the drawing; the recipe's name if left out", default="")
    number: str = entry("the drawing's number", default="")
    revision: str = entry("the drawing's revision", default="")
    material: str = entry("material of the parts", default="")
    general_tolerance: str = entry("tolerance of sizes without their own; of gears, their accuracy class", default="")
    drawn_by: str = entry("name of the draughtsman", default="")
    date: str = entry("date of the drawing, as any text", default="")

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if flaw := _flaw(value):
                allowed = f"give at most {LONGEST} letters of any script, digits and signs, {SIGNS} too"
                raise DesignError(field.name, f"found {shown(value)}, which {flaw}", allowed, "out-of-range")

    def lines(self) -> Iterator[str]:
        """The entries besides the name, each with its label."""
        for field in fields(self)[1:]:
            if value := getattr(self, field.name):
                yield f"{field.name.replace('_', ' ')}: {value}"


def _flaw(text: str) -> str:
    """The reason why a text is not allowed in a drawing; empty if it is."""
    if len(text) > LONGEST:
        return f"has {len(text)} letters"
    if text != text.strip():
        return "begins or ends with a space"
    previous = ""
    for sign in unicodedata.normalize("NFC", text):
        plain = sign.isascii() and sign.isprintable() and sign not in CODES
        if not (plain or sign in SIGNS or is_letter(sign, previous)):
            return f"has the sign {shown(sign)}"
        previous = sign
    return "has two signs of per cent in a row" if "%%" in text else ""


# Width of a letter over the height of capitals: for the widest fonts of CAD programs, and for letters as wide as a
# line is high, as in Chinese. Smaller values let texts overlap.
WIDE, WIDEST = 1.0, 1.5


@record(eq=False)
class Text:
    """A line of text, with its height of capitals, mm.

    `place` is its middle, mm, or the middle of its left end if `starts`, of its right end if `ends`. A `turned` one is
    read from the right.
    """

    layer: str
    text: str
    place: complex
    height: float
    starts: bool = False
    ends: bool = False
    turned: bool = False

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of the largest extent of the text, mm."""
        half = complex(width_of(self.text, self.height), self.height) / 2
        along = 1j if self.turned else 1
        middle = self.place + along * half.real * (self.starts - self.ends)
        half = complex(half.imag, half.real) if self.turned else half
        return middle - half, middle + half


def width_of(words: str, height: float) -> float:
    """Largest width of a text, mm."""
    return height * sum(WIDEST if east_asian_width(letter) in "WF" else WIDE for letter in words)


def text(raw: str) -> str:
    """A text of a recipe as HTML without markup or effect on its surroundings."""
    return escape(harmless(raw))


def number(value: float, digits: int = DIGITS) -> str:
    """A number with so many significant digits for readers: in full below ten million, in groups of three."""
    if not np.isfinite(value):
        return "none" if np.isnan(value) else "infinite"
    decimals = max(0, digits - len(f"{abs(value):.0f}"))
    plain = f"{value:,.{decimals}f}" if 1e4 <= abs(value) < 1e7 else f"{value:.{digits}g}"
    return "0" if plain == "-0" else plain.replace("-", "\N{MINUS SIGN}")


def with_unit(value: float, unit: str, digits: int = 4) -> str:
    """A value with its unit for readers."""
    sign = unit_sign(unit)
    return f"{number(float(value), digits)}{'' if sign in ('', '°') else ' '}{sign}"


def unit_sign(unit: str) -> str:
    """A unit, or a text with units, with the signs that print has for degrees and squares."""
    signs = {"2": "²", "3": "³"}
    return re.sub(r"(?<=[a-z])[23]\b", lambda power: signs[power[0]], re.sub(r"\bdeg\b", "°", unit))


def capital(words: str) -> str:
    """Text with a capital first letter and spaces for underscores."""
    words = words.replace("_", " ")
    return words[:1].upper() + words[1:]


# A line for each character: its left and right side, then x and y, y down, of the points of its strokes, each number
# as a letter, R for 0; a space instead of an x, with R, ends a stroke.
STROKES = r"""
JZ
MWRFRT RRYQZR[SZRY
JZNFNM RVFVM
H]SBLb RYBRb RLOZO RKUYU
H\PBP_ RTBT_ RYIWGTFPFMGKIKKLMMNOOUQWRXSYUYXWZT[P[MZKX
F^[FI[ RNFPHPJOLMMKMIKIIJGLFNFPGSHVHYG[F RWTUUTWTYV[X[ZZ[X[VYTWT
E_\O\N[MZMYNXPVUTXRZP[L[JZIYHWHUISJRQNRMSKSIRGPFNGMIMKNNPQUXWZY[[[\Z\Y
MWRHQGRFSGSIRKQL
KYVBTDRGPKOPOTPYR]T`Vb
KYNBPDRGTKUPUTTYR]P`Nb
JZRLRX RMOWU RWOMU
E_RIR[ RIR[R
NVSWRXQWRVSWSYQ[
E_IR[R
NVRVQWRXSWRV
G][BIb
H\QFNGLJKOKRLWNZQ[S[VZXWYRYOXJVGSFQF
H\NJPISFS[
H\LKLJMHNGPFTFVGWHXJXLWNUQK[Y[
H\MFXFRNUNWOXPYSYUXXVZS[P[MZLYKW
H\UFKTZT RUFU[
H\WFMFLOMNPMSMVNXPYSYUXXVZS[P[MZLYKW
H\XIWGTFRFOGMJLOLTMXOZR[S[VZXXYUYTXQVOSNRNOOMQLT
H\YFO[ RKFYF
H\PFMGLILKMMONSOVPXRYTYWXYWZT[P[MZLYKWKTLRNPQOUNWMXKXIWGTFPF
H\XMWPURRSQSNRLPKMKLLINGQFRFUGWIXMXRWWUZR[P[MZLX
NVROQPRQSPRO RRVQWRXSWRV
NVROQPRQSPRO RSWRXQWRVSWSYQ[
F^ZIJRZ[
E_IO[O RIU[U
F^JIZRJ[
I[LKLJMHNGPFTFVGWHXJXLWNVORQRT RRYQZR[SZRY
E`WNVLTKQKOLNMMPMSNUPVSVUUVS RQKOMNPNSOUPV RWKVSVUXVZV\T]Q]O\L[JYHWGTFQFNGLHJJILHOHRIUJWLYNZQ[T[WZYYZX RXKWSWUXV
I[RFJ[ RRFZ[ RMTWT
G\KFK[ RKFTFWGXHYJYLXNWOTP RKPTPWQXRYTYWXYWZT[K[
H]ZKYIWGUFQFOGMILKKNKSLVMXOZQ[U[WZYXZV
G\KFK[ RKFRFUGWIXKYNYSXVWXUZR[K[
H[LFL[ RLFYF RLPTP RL[Y[
HZLFL[ RLFYF RLPTP
H]ZKYIWGUFQFOGMILKKNKSLVMXOZQ[U[WZYXZVZS RUSZS
G]KFK[ RYFY[ RKPYP
NVRFR[
JZVFVVUYTZR[P[NZMYLVLT
G\KFK[ RYFKT RPOY[
HYLFL[ RL[X[
F^JFJ[ RJFR[ RZFR[ RZFZ[
G]KFK[ RKFY[ RYFY[
G]PFNGLIKKJNJSKVLXNZP[T[VZXXYVZSZNYKXIVGTFPF
G\KFK[ RKFTFWGXHYJYMXOWPTQKQ
G]PFNGLIKKJNJSKVLXNZP[T[VZXXYVZSZNYKXIVGTFPF RSWY]
G\KFK[ RKFTFWGXHYJYLXNWOTPKP RRPY[
H\YIWGTFPFMGKIKKLMMNOOUQWRXSYUYXWZT[P[MZKX
JZRFR[ RKFYF
G]KFKULXNZQ[S[VZXXYUYF
I[JFR[ RZFR[
F^HFM[ RRFM[ RRFW[ R\FW[
H\KFY[ RYFK[
I[JFRPR[ RZFRP
H\YFK[ RKFYF RK[Y[
KYOBOb RPBPb ROBVB RObVb
KYKFY^
KYTBTb RUBUb RNBUB RNbUb
JZRDJR RRDZR
I[Ib[b
NVSKQMQORPSORNQO
I\XMX[ RXPVNTMQMONMPLSLUMXOZQ[T[VZXX
H[LFL[ RLPNNPMSMUNWPXSXUWXUZS[P[NZLX
I[XPVNTMQMONMPLSLUMXOZQ[T[VZXX
I\XFX[ RXPVNTMQMONMPLSLUMXOZQ[T[VZXX
I[LSXSXQWOVNTMQMONMPLSLUMXOZQ[T[VZXX
MYWFUFSGRJR[ ROMVM
I\XMX]W`VaTbQbOa RXPVNTMQMONMPLSLUMXOZQ[T[VZXX
I\MFM[ RMQPNRMUMWNXQX[
NVQFRGSFREQF RRMR[
MWRFSGTFSERF RSMS^RaPbNb
IZMFM[ RWMMW RQSX[
NVRFR[
CaGMG[ RGQJNLMOMQNRQR[ RRQUNWMZM\N]Q][
I\MMM[ RMQPNRMUMWNXQX[
I\QMONMPLSLUMXOZQ[T[VZXXYUYSXPVNTMQM
H[LMLb RLPNNPMSMUNWPXSXUWXUZS[P[NZLX
I\XMXb RXPVNTMQMONMPLSLUMXOZQ[T[VZXX
KXOMO[ ROSPPRNTMWM
J[XPWNTMQMNNMPNRPSUTWUXWXXWZT[Q[NZMX
MYRFRWSZU[W[ ROMVM
I\MMMWNZP[S[UZXW RXMX[
JZLMR[ RXMR[
G]JMN[ RRMN[ RRMV[ RZMV[
J[MMX[ RXMM[
JZLMR[ RXMR[P_NaLbKb
J[XMM[ RMMXM RM[X[
KYTBRCQDPFPHQJRKSMSOQQ RRCQEQGRISJTLTNSPORSTTVTXSZR[Q]Q_Ra RQSSUSWRYQZP\P^Q`RaTb
NVRBRb
KYPBRCSDTFTHSJRKQMQOSQ RRCSESGRIQJPLPNQPURQTPVPXQZR[S]S_Ra RSSQUQWRYSZT\T^S`RaPb
F^IUISJPLONOPPTSVTXTZS[Q RISJQLPNPPQTTVUXUZT[Q[O
"""
FIRST, NOUGHT, LIFT = ord(" "), ord("R"), " R"
_LINES = STROKES[1:-1].split("\n")


def lines_of(words: str) -> list[list[tuple[int, int]]]:
    """Strokes of an ASCII text in the font's units: points x, y, with y down and x from the left end."""
    strokes, start = [], 0
    for sign in words:
        line = _LINES[ord(sign) - FIRST]
        left, right = _numbers(line[:2])
        for stroke in filter(None, line[2:].split(LIFT)):
            coordinates = _numbers(stroke)
            strokes.append([(start + x - left, y) for x, y in zip(coordinates[::2], coordinates[1::2])])
        start += right - left
    return strokes


def _numbers(letters: str) -> list[int]:
    return [ord(letter) - NOUGHT for letter in letters]


# Heights of capitals, mm, tried from the largest. Larger ones dominate the part; a laser fills in smaller ones.
HEIGHTS = (5.0, 4.0, 3.0, 2.5)
# Gap around lettering, mm; with less a stroke may meet a cut because of a machine's inaccuracy.
MARGIN = 0.8
# Numbers of positions tried along and across a part. Fewer miss free room; more take longer without a visible effect.
ALONG, ACROSS = 41, 13
# Positions tried around a hole for its letter.
ROUND = 32
# Tolerance, mm, of the part's chords for finding room, far below the margin.
CHORDS = 0.05
# The same for a hole whose letter found no room: its chords then have every direction.
FINER = 1e-4
# Height of the font's capitals above its baseline, and the baseline, in the font's units, y down.
CAPITAL, BASELINE = 21.0, 9.0
# Relative difference of length and width, as a share of the spread, below which a part counts as round.
EVEN = 0.02
# Share by which a box may exceed its room: invisible, but far more than rounding.
HAIR = 1e-5
# Decimals of mm of the strokes.
DECIMALS = 3


def lettered(part: Part, number: int) -> tuple[str, tuple[Complex, ...]]:
    """The text engraved on a part, and all strokes in the part's frame, mm: letters at its holes, then its name.

    The part's `number` replaces a name that the font cannot write or that does not fit; the text is "" if neither fits.
    A letter that does not fit is omitted.
    """
    room = _Room(part)
    strokes: list[Complex] = []
    for hole, letter in zip(part.holes, map(_without_accents, part.hole_names)):
        if letter:
            # A narrow bar has room only lengthwise, and the few chords of a small hole may not include that direction.
            strokes += room.beside(flatten(hole, CHORDS), letter) or room.beside(flatten(hole, FINER), letter)
    for words in (_without_accents(part.name), str(number)):
        if words and (name_strokes := room.anywhere(words)):
            return words, (*strokes, *name_strokes)
    return "", tuple(strokes)


def _without_accents(name: str) -> str:
    """The name in the font's letters without accents; "" if it has others."""
    bare = "".join(c for c in unicodedata.normalize("NFKD", name) if not unicodedata.combining(c))
    return bare.strip() if bare.isascii() and bare.isprintable() else ""


@cache
def strokes_of(words: str) -> tuple[Complex, ...]:
    """The strokes of a text with capitals of height 1 on y = 0 from x = 0."""
    lines = [np.array([x + 1j * (BASELINE - y) for x, y in stroke]) / CAPITAL for stroke in lines_of(words)]
    left = min((line.real.min() for line in lines), default=0.0)
    return tuple(line - left for line in lines)


class _Room:
    """A part rotated so that its lettering is level, with the occupied regions."""

    def __init__(self, part: Part) -> None:
        loops = [flatten(curve, CHORDS) for curve in (part.outline, *part.holes)]
        self.direction = _main_direction(loops[0])
        self.loops = [z / self.direction for z in loops]
        self.occupied = [flatten(mark, CHORDS) / self.direction for mark in part.marks]

    def anywhere(self, words: str) -> list[Complex]:
        """The strokes of a text, as large and as near to the middle as possible; empty if it does not fit."""
        low, high = box_of(self.loops[0])
        x, y = np.meshgrid(np.linspace(low.real, high.real, ALONG), np.linspace(low.imag, high.imag, ACROSS))
        places = (x + 1j * y).ravel()
        # Rounded, so that last digits do not decide between equal distances.
        places = places[np.argsort(np.round(np.abs(places - (low + high) / 2), 6), kind="stable")]
        trials = (self._at(words, height, places) for height in HEIGHTS)
        return next((strokes for strokes in trials if strokes), [])

    def beside(self, hole: Complex, letter: str) -> list[Complex]:
        """The strokes of a letter next to a hole, whose room is then occupied; empty if it does not fit."""
        low, high = box_of(np.concatenate(strokes_of(letter)))
        half = (high - low) * HEIGHTS[-1] / 2 + MARGIN * (1 + 1j)
        ring = np.append(hole, hole[:1]) / self.direction
        length = np.append(0.0, np.cumsum(np.abs(np.diff(ring))))
        edge_parameter = np.interp((np.arange(ROUND) + 0.5) / ROUND * length[-1], length, np.arange(len(ring)))
        edge = edge_parameter.astype(int)
        edge_vector = ring[edge + 1] - ring[edge]
        normal = -1j * edge_vector / np.abs(edge_vector) * np.sign(measure.signed_area(Polyline(hole)))
        places = (
            ring[edge]
            + (edge_parameter - edge) * edge_vector
            + normal * (half.real * np.abs(normal.real) + half.imag * np.abs(normal.imag))
        )
        # Positions above come first, since a bar's name is on its middle line, then those near the middle of a slot.
        distance = np.round(np.abs(places - ring.mean()) / np.abs(places - ring.mean()).max(), 6)
        return self._at(letter, HEIGHTS[-1], places[np.lexsort((distance, -np.round(normal.imag, 6)))])

    def _at(self, words: str, height: float, places: Complex) -> list[Complex]:
        """The strokes at the first of the positions with room for them."""
        strokes = strokes_of(words)
        low, high = box_of(np.concatenate(strokes))
        half = (high - low) * height / 2 + MARGIN * (1 + 1j)
        boxes = places[:, None] + np.array([-half, np.conj(half), half, -np.conj(half)])
        # The box is reduced slightly, so that rounding does not decide about room that just suffices.
        free = region.holds(self.loops, places[:, None] + (boxes - places[:, None]) * (1 - HAIR), self.occupied)
        if not free.any():
            return []
        first = int(np.argmax(free))
        self.occupied.append(np.append(boxes[first], boxes[first][:1]))
        shift = complex(places[first]) - (high + low) / 2 * height
        return [rounded((line * height + shift) * self.direction, DECIMALS) for line in strokes]


def _main_direction(outline: Complex) -> complex:
    """Direction of the greatest length of a part, oriented so that its lettering is not upside down."""
    about = outline - outline.mean()
    # The square of the principal direction.
    twice = complex((about**2).sum())
    if abs(twice) < EVEN * float((np.abs(about) ** 2).sum()):
        return 1.0 + 0j
    direction = complex(np.sqrt(twice / abs(twice)))
    level = abs(direction.real) > 1e-9
    return direction if (direction.real if level else direction.imag) > 0 else -direction


def as_json(data: object) -> object:
    """Data with "inf", "-inf" and null (nan) in place of numbers that JSON does not have."""
    if isinstance(data, Mapping):
        return {name: as_json(value) for name, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [as_json(value) for value in data]
    if isinstance(data, float) and not isfinite(data):
        return None if data != data else str(float(data))
    return data
