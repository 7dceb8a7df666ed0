"""Letters of single strokes: the signs from space to tilde of the plain sans-serif font of A. V. Hershey.

The Hershey Fonts were originally created by Dr. A. V. Hershey while working at the U. S. National Bureau of Standards.
The format of the font data was originally created by James Hurt, Cognition, Inc., 900 Technology Park Drive, Billerica,
MA 01821. The data may be used by anyone for any purpose, and be converted into any other format except the one that is
distributed by the U. S. National Technical Information Service.
"""

from __future__ import annotations

import unicodedata
from functools import cache

import numpy as np

from ..model.part import Part
from ..plane import measure as measure
from ..plane import region as region
from ..plane.flatten import flatten
from ..plane.primitives import Polyline
from ..plane.vec import Complex, rounded

# A line for each sign: its left and right side, then x and y, y down, of the points of its strokes, each number as a
# letter, R for 0; a space instead of an x, with R, ends a stroke.
SIGNS = r"""
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
_LINES = SIGNS[1:-1].split("\n")


def lines_of(words: str) -> list[list[tuple[int, int]]]:
    """Strokes of a text, in the font's own units: points x, y, y down, x from the left side of the first sign.

    Words are of the signs from space to tilde.
    """
    found, start = [], 0
    for sign in words:
        line = _LINES[ord(sign) - FIRST]
        left, right = _numbers(line[:2])
        for stroke in filter(None, line[2:].split(LIFT)):
            places = _numbers(stroke)
            found.append([(start + x - left, y) for x, y in zip(places[::2], places[1::2])])
        start += right - left
    return found


def _numbers(letters: str) -> list[int]:
    return [ord(letter) - NOUGHT for letter in letters]


# Heights of capitals, mm, tried from the largest: above the first a name shouts, below the last a laser burns it shut.
HEIGHTS = (5.0, 4.0, 3.0, 2.5)
# Clear space round lettering, mm: less, and a stroke runs into a cut by what beams and belts are off.
MARGIN = 0.8
# Places tried along and across a part. Fewer miss room that is there; more take longer, and nobody sees the difference.
ALONG, ACROSS = 41, 13
# Places tried round a hole for its letter, as above.
ROUND = 32
# Chords, mm, of the part for finding room: far finer than the margin.
CHORDS = 0.05
# The same round a hole whose letter has found no room: so fine that its chords face every way.
FINER = 1e-4
# Of the font: from its baseline to the top of its capitals, and the baseline, in its own units, y down.
CAPITAL, BASELINE = 21.0, 9.0
# How little longer than wide a part may be and count as round, with no direction of its own: as a share of its spread.
EVEN = 0.02
# Share by which a box may be larger than its room: far less than is seen, far more than rounding.
HAIR = 1e-5
# Decimals of mm of the strokes.
DIGITS = 3


def lettered(part: Part, number: int) -> tuple[str, tuple[Complex, ...]]:
    """What is engraved on a part, and all strokes in the part's frame, mm: letters at its holes, then its name.

    number: in the list of parts. A name with letters that the font has not, or that finds no room, gives way to the
    number; "" where that finds none either. A letter without room is left out.
    """
    room = _Room(part)
    strokes: list[Complex] = []
    for hole, letter in zip(part.holes, map(_plain, part.hole_names)):
        if letter:
            # The few chords of a small hole may all face aside where a narrow bar has room along it alone.
            strokes += room.beside(flatten(hole, CHORDS), letter) or room.beside(flatten(hole, FINER), letter)
    for words in (_plain(part.name), str(number)):
        if words and (found := room.anywhere(words)):
            return words, (*strokes, *found)
    return "", tuple(strokes)


def _plain(name: str) -> str:
    """The name in letters that the font has, accents left out; "" where it has not all of them."""
    bare = "".join(c for c in unicodedata.normalize("NFKD", name) if not unicodedata.combining(c))
    return bare.strip() if bare.isascii() and bare.isprintable() else ""


@cache
def strokes_of(words: str) -> tuple[Complex, ...]:
    """The strokes of a text, capitals 1 high, on y = 0 from x = 0."""
    lines = [np.array([x + 1j * (BASELINE - y) for x, y in stroke]) / CAPITAL for stroke in lines_of(words)]
    left = min((line.real.min() for line in lines), default=0.0)
    return tuple(line - left for line in lines)


class _Room:
    """A part turned so that its lettering runs level, and what in it is taken."""

    def __init__(self, part: Part) -> None:
        loops = [flatten(curve, CHORDS) for curve in (part.outline, *part.holes)]
        self.ahead = _ahead(loops[0])
        self.loops = [z / self.ahead for z in loops]
        self.taken = [flatten(mark, CHORDS) / self.ahead for mark in part.marks]

    def anywhere(self, words: str) -> list[Complex]:
        """The strokes of a text as large and as near to the middle as finds room; none where there is none."""
        low, high = _box(self.loops[0])
        x, y = np.meshgrid(np.linspace(low.real, high.real, ALONG), np.linspace(low.imag, high.imag, ACROSS))
        places = (x + 1j * y).ravel()
        # Equally far ones in their order, whatever the last digit says.
        places = places[np.argsort(np.round(np.abs(places - (low + high) / 2), 6), kind="stable")]
        found = (self._at(words, height, places) for height in HEIGHTS)
        return next((strokes for strokes in found if strokes), [])

    def beside(self, hole: Complex, letter: str) -> list[Complex]:
        """The strokes of a letter next to a hole, and their room taken from then on; none where there is none."""
        low, high = _box(np.concatenate(strokes_of(letter)))
        half = (high - low) * HEIGHTS[-1] / 2 + MARGIN * (1 + 1j)
        ring = np.append(hole, hole[:1]) / self.ahead
        passed = np.append(0.0, np.cumsum(np.abs(np.diff(ring))))
        at = np.interp((np.arange(ROUND) + 0.5) / ROUND * passed[-1], passed, np.arange(len(ring)))
        edge = at.astype(int)
        way = ring[edge + 1] - ring[edge]
        out = -1j * way / np.abs(way) * np.sign(measure.signed_area(Polyline(hole)))
        places = ring[edge] + (at - edge) * way + out * (half.real * np.abs(out.real) + half.imag * np.abs(out.imag))
        # Above first: on a bar's middle line its name has its place; and beside the middle of a slot.
        far = np.round(np.abs(places - ring.mean()) / np.abs(places - ring.mean()).max(), 6)
        return self._at(letter, HEIGHTS[-1], places[np.lexsort((far, -np.round(out.imag, 6)))])

    def _at(self, words: str, height: float, places: Complex) -> list[Complex]:
        """The strokes about the first of the places that has room for them."""
        strokes = strokes_of(words)
        low, high = _box(np.concatenate(strokes))
        half = (high - low) * height / 2 + MARGIN * (1 + 1j)
        boxes = places[:, None] + np.array([-half, np.conj(half), half, -np.conj(half)])
        # Room that is just enough is enough: no last digit may decide.
        free = region.holds(self.loops, places[:, None] + (boxes - places[:, None]) * (1 - HAIR), self.taken)
        if not free.any():
            return []
        first = int(np.argmax(free))
        self.taken.append(np.append(boxes[first], boxes[first][:1]))
        shift = complex(places[first]) - (high + low) / 2 * height
        return [rounded((line * height + shift) * self.ahead, DIGITS) for line in strokes]


def _box(z: Complex) -> tuple[complex, complex]:
    return complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())


def _ahead(outline: Complex) -> complex:
    """Direction in which a part is longest, so turned that its lettering is not upside down."""
    about = outline - outline.mean()
    # The square of the main axis.
    twice = complex((about**2).sum())
    if abs(twice) < EVEN * float((np.abs(about) ** 2).sum()):
        return 1.0 + 0j
    ahead = complex(np.sqrt(twice / abs(twice)))
    level = abs(ahead.real) > 1e-9
    return ahead if (ahead.real if level else ahead.imag) > 0 else -ahead
