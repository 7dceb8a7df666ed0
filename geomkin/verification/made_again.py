"""Files compared with those that their recipe makes again: the same but for last digits, or the places that differ."""

from __future__ import annotations

import csv
import io
import re
import struct
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import takewhile

import numpy as np

from ..core.errors import printable
from ..core.records import record
from ..export.summary import NAME
from ..plane.vec import Real
from .outline import LARGEST, UnreadableError

# Relative difference of numbers that were written with ten digits; absolute one as a share of a column's size, or of
# the coordinates of a mesh, which are of single precision; and that of any other number, in the unit of the file.
CLOSE, NOISE, SINGLE, ZERO = 2e-9, 1e-10, 2.0**-22, 1e-12
# Largest unit of the last decimal by which a number may differ. Coarser ones are rounded alike on every processor.
LAST = 1e-6
PACKAGES = ("3mf", "assembly-3mf")
PDF = ("report", "sheet-pdf")
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
# What is compared in a text: its numbers, and colours and references, which are none though `#009e73` reads as one.
VALUE = re.compile(rf"#[-+.\w]*|{NUMBER.pattern}")
# The version of a package.
VERSION = r"[0-9][0-9A-Za-z.+!_-]{0,40}"
# The pieces of a file that are compared: tags and the text between them, pairs of a group code and its value, lines.
TAGS, PAIRS, LINES = (re.compile(piece) for piece in (r"<[^>]*>?|[^<]+", r"[^\n]*\n[^\n]*\n?", r"[^\n]*\n|[^\n]+"))
# Members of a package that are read.
MEMBERS = 10


@record(eq=False)
class Difference:
    """The differences of a file from the one made again.

    problems: a sentence for each difference that is not one of last digits; digits: number of pieces with such a one.
    """

    problems: tuple[str, ...] = ()
    digits: int = 0

    @property
    def note(self) -> str:
        """One sentence on the first difference of the bytes."""
        if self.problems:
            return self.problems[0]
        in_digits = f"{self.digits} numbers or lines differ in their last digits"
        return in_digits if self.digits else "its bytes differ, but neither its numbers nor its texts"


def difference(found: bytes, expected: bytes, kind: str, measured: bool = False) -> Difference | None:
    """The differences of a file of a format; None if its bytes are equal.

    measured: without the geometry, which is measured in its place.
    """
    if found == expected:
        return None
    if kind in ("csv", "bom"):
        return _cells_apart(read_cells(found), read_cells(expected))
    (here, numbers), (there, wanted) = _content(found, kind), _content(expected, kind)
    if measured:
        here, there = without_geometry(here, kind), without_geometry(there, kind)
    apart = _texts_apart(here, there, kind)
    if apart.problems:
        return apart
    if kind in PACKAGES and not _is_packed(found):
        return Difference(("its members are packed in another way than geomkin packs them",))
    if not measured and not _close_arrays(numbers, wanted, kind):
        return Difference(("its corners or triangles are not those that the recipe makes",))
    return apart


def _content(content: bytes, kind: str) -> tuple[str, bytes]:
    """The text of a file, whatever is not geometry included, and its binary numbers."""
    if kind == "stl":
        rest = np.frombuffer(content[84 : 84 + (len(content) - 84) // 50 * 50], np.uint8).reshape(-1, 50)
        odd = rest[:, 48:].tobytes().strip(b"\0") + content[84 + rest.size :]
        count = b"" if content[80:84] == struct.pack("<I", len(rest)) else content[80:84]
        head = (content[:80].rstrip(b"\0") + count).decode("latin-1")
        return f"{head}\n{odd.hex()}", np.ascontiguousarray(rest[:, :48]).tobytes()
    if kind == "glb":
        if len(content) < 28:
            raise UnreadableError("it is truncated")
        end = 20 + struct.unpack_from("<I", content, 12)[0]
        data = content[20:end].decode("utf-8", "backslashreplace").replace(",", ",\n")
        return f"{content[:20].hex()}\n{data}\n{content[end : end + 8].hex()}", content[end + 8 :]
    if kind in PACKAGES:
        return "".join(f"<!-- {name} -->\n{text}\n" for name, text in members(content)), b""
    text = content.decode("utf-8", "backslashreplace")
    if kind not in PDF:
        # Programs that copy texts change the ends of lines, or put a mark before the first, with which DXF and STEP
        # cannot be read.
        text = text.removeprefix("" if kind.endswith(("dxf", "step")) else "\ufeff").replace("\r\n", "\n")
    # The version of the program that wrote a file is stated, but not compared.
    if kind in ("step", "assembly-step"):
        return re.sub(rf"'geomkin {VERSION}'", "", text, count=1), b""
    if kind == NAME:
        before, mark, after = text.rpartition('"versions": {')
        return before + mark + re.sub(rf'": "{VERSION}"', '": ""', after), b""
    return text, b""


def members(content: bytes) -> Iterator[tuple[str, str]]:
    """Names and texts of the members of a package, unpacked up to a limit, whatever it states of its sizes."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as package:
            inside = package.infolist()
            if len(inside) > MEMBERS or any(one.compress_type not in (0, zipfile.ZIP_DEFLATED) for one in inside):
                raise UnreadableError(f"it has more than {MEMBERS} members, or one that is packed in a rare way")
            left = LARGEST
            for one in inside:
                with package.open(one) as file:
                    text = file.read(left + 1)
                if (left := left - len(text)) < 0:
                    raise UnreadableError(f"it unpacks to more than {LARGEST:,} bytes")
                yield one.filename, text.decode("utf-8", "backslashreplace")
    except (OSError, ValueError, RuntimeError, EOFError, zipfile.BadZipFile, zlib.error) as fault:
        raise UnreadableError(f"it is not a 3MF package ({type(fault).__name__})") from None


def _is_packed(content: bytes) -> bool:
    """Whether a package is the one that the writer makes of its members, with nothing between or after them."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as package:
        for name, text in members(content):
            package.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), text)
    return stream.getvalue() == content


def without_geometry(text: str, kind: str) -> str:
    """The text of a file without the numbers that are measured."""
    if kind == "svg":
        return re.sub(r'\b(d|cx|cy|r)="[^"]*"', r'\1=""', text)
    if kind == "3mf":
        text = re.sub(r'<(?:vertex x="[^"]*" y="[^"]*" z="[^"]*"|triangle v1="\d+" v2="\d+" v3="\d+")/>', "", text)
        return re.sub(r'(<item objectid="\d+" transform=)"[^"]*"', r'\1""', text)
    return "".join(_groups(text)) if kind == "dxf" else text


def _groups(text: str) -> Iterator[str]:
    """The groups of a DXF file without the places and sizes of circles and polylines in its model space."""
    inside, entity = False, ""
    pairs = [tuple(pair.split("\n")[:2]) for pair in PAIRS.findall(text)]
    for k, (code, value) in enumerate(pairs):
        key = code.strip()
        if key == "0":
            entity = value
        elif key == "2" and entity == "SECTION":
            inside = value == "ENTITIES"
        if inside and entity in ("LWPOLYLINE", "VERTEX") and key in ("10", "20", "42"):
            continue
        if inside and entity == "LWPOLYLINE" and key == "90":
            following = (pairs[j][0].strip() for j in range(k + 1, len(pairs)))
            codes = Counter(takewhile(lambda code: code != "0", following))
            value = "" if value.strip() == str(codes["10"]) == str(codes["20"]) else value
        yield f"{code}\n{'' if inside and entity == 'CIRCLE' and key in ('10', '20', '40') else value}\n"


def _texts_apart(found: str, expected: str, kind: str) -> Difference:
    """The differences of two texts, piece by piece: what is alike at both ends first, then the rest as a whole."""
    if found == expected:
        return Difference()
    splitter = PAIRS if kind.endswith("dxf") else TAGS if expected.lstrip()[:1] == "<" else LINES
    here, there = splitter.findall(found), splitter.findall(expected)
    first = _alike(here, there)
    last = _alike(here[first:][::-1], there[first:][::-1])
    rest, wanted = here[first : len(here) - last], there[first : len(there) - last]
    if not rest and not wanted:
        return Difference((), sum(a != b for a, b in zip(here, there)))
    further, missing = (
        [piece for piece in (Counter(one) - Counter(other)).elements() if piece.strip()]
        for one, other in ((rest, wanted), (wanted, rest))
    )
    place = f"at line {''.join(here[:first]).count(chr(10)) + 1}"
    if further and missing:
        more = f" ({max(len(further), len(missing))} such differences)" if len(further) + len(missing) > 2 else ""
        problem = f"{place} it has {_piece(further[0])}, and the recipe makes {_piece(missing[0])}{more}"
    elif further:
        problem = f"{place} it has {_piece(further[0])}, which geomkin does not write (of {len(further)} in all)"
    elif missing:
        problem = f"{place} it lacks {_piece(missing[0])} (of {len(missing)} in all)"
    else:
        problem = f"its elements are in another order, or spaced in another way, from line {place[8:]} on"
    return Difference((problem,))


def _piece(text: str) -> str:
    return printable(" ".join(text.split()), 90)


def _alike(here: Sequence[str], there: Sequence[str]) -> int:
    """The number of pieces at the start of two sequences that are the same but for last digits."""
    pairs = enumerate(zip(here, there))
    return next((k for k, (a, b) in pairs if a != b and not _close(a, b)), min(len(here), len(there)))


def _close(found: str, expected: str) -> bool:
    """Whether two texts are the same but for the last digits of numbers that are not whole."""
    if VALUE.split(found) != VALUE.split(expected):
        return False
    return all(a == b or _close_numbers(a, b) for a, b in zip(VALUE.findall(found), VALUE.findall(expected)))


def _close_numbers(found: str, expected: str) -> bool:
    if "#" in found + expected or not {".", "e", "E"} & {*found, *expected}:
        return False
    a, b = float(found), float(expected)
    unit = max(min(_last_decimal(found), _last_decimal(expected)), 1e-300)
    return abs(a - b) <= max(CLOSE * max(abs(a), abs(b)), 1.01 * unit * (unit <= LAST), ZERO)


def _last_decimal(number: str) -> float:
    """The unit of the last decimal of a number."""
    mantissa, _, exponent = number.lower().partition("e")
    power = float(exponent or 0) - len(mantissa.partition(".")[2])
    return float(10.0 ** min(max(power, -300), 300))


def _close_arrays(found: bytes, expected: bytes, kind: str) -> bool:
    """Whether binary numbers are the same but for the rounding of single precision."""
    if len(found) != len(expected) or len(found) % 4:
        return found == expected
    same = np.frombuffer(found, "<u4") == np.frombuffer(expected, "<u4")
    with np.errstate(invalid="ignore", over="ignore"):
        a, b = (np.frombuffer(content, "<f4").astype(float) for content in (found, expected))
        if kind == "stl":
            return bool((same | (np.abs(a - b) <= SINGLE * np.abs(b).max(initial=1.0))).all())
        # Colours and numbers of corners, which read as a number are tiny, huge or none, must be the same.
        known = (np.abs(b) > 1e-9) & (np.abs(b) < 1e9)
        return bool((same | known & (np.abs(a - b) <= SINGLE * np.abs(b))).all())


def read_cells(content: bytes) -> list[list[str]]:
    """The cells of a CSV file, line by line; UnreadableError if it is not CSV."""
    try:
        rows = list(csv.reader(content.decode("utf-8-sig").splitlines()))
    except (UnicodeDecodeError, csv.Error) as fault:
        raise UnreadableError(f"it is not CSV ({type(fault).__name__})") from None
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise UnreadableError("its rows have different numbers of cells")
    return rows


def _cells_apart(found: list[list[str]], expected: list[list[str]]) -> Difference:
    """The differences of two tables, column by column."""
    if found[0] != expected[0]:
        return Difference(("its columns are not those of the recipe",))
    if len(found) != len(expected):
        return Difference((f"it has {len(found) - 1} rows, and the recipe {len(expected) - 1}",))
    problems, digits = [], 0
    for name, cells, wanted in zip(expected[0], zip(*found[1:]), zip(*expected[1:])):
        numbers, known = _as_numbers(cells), _as_numbers(wanted)
        size = np.abs(known[np.isfinite(known)]).max(initial=0.0)
        with np.errstate(invalid="ignore"):
            near = np.abs(numbers - known) <= CLOSE * np.abs(known) + NOISE * size + ZERO
        whole = np.array([not {".", "e"} & {*a, *b} for a, b in zip(cells, wanted)], dtype=bool)
        different = np.array([a != b for a, b in zip(cells, wanted)], dtype=bool)
        wrong = np.flatnonzero(different & (~near | whole))
        digits += int(np.count_nonzero(different))
        if len(wrong):
            k = int(wrong[0])
            problems.append(
                f"row {k + 2} of {printable(name, 60)} has {printable(cells[k], 40) or 'nothing'}, and the recipe "
                f"{printable(wanted[k], 40) or 'nothing'} ({len(wrong)} such rows)"
            )
    return Difference(tuple(problems), digits)


def _as_numbers(cells: Sequence[str]) -> Real:
    return np.array([float(cell) if NUMBER.fullmatch(cell) else np.nan for cell in cells])
