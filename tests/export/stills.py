"""Pictures read back by plain parsing: their groups, where transforms set them, and how key frames move them."""

import re
import xml.etree.ElementTree as ET

import numpy as np

SPACE = "{http://www.w3.org/2000/svg}"
NUMBER = r"-?\d*\.?\d+(?:e-?\d+)?"


def placed(text):
    """A transform's text as a map of complex points."""
    steps = []
    for name, inside in re.findall(r"(\w+)\(([^)]*)\)", text or ""):
        numbers = [float(n) for n in re.findall(NUMBER, inside)]
        if name == "translate":
            steps.append(lambda z, by=complex(*numbers): z + by)
        elif name == "rotate":
            steps.append(lambda z, by=np.exp(1j * np.radians(numbers[0])): z * by)
        elif name == "scale" and len(numbers) == 1:
            steps.append(lambda z, by=numbers[0]: z * by)
        else:
            raise AssertionError(name)

    def at(z):
        for step in reversed(steps):
            z = step(z)
        return z

    return at


def loops(d):
    """The loops of a path's text as points, and its circles as (centre, radius)."""
    polygons, circles = [], []
    for piece in re.findall(r"M[^M]*", d):
        numbers = [float(n) for n in re.findall(NUMBER, piece)]
        if "a" in piece and "l" in piece:
            polygons.append(np.cumsum(stepped(piece)))
        elif "a" in piece:
            circles.append((complex(numbers[0] + numbers[2], numbers[1]), numbers[2]))
        else:
            polygons.append(np.cumsum(np.array(numbers[::2]) + 1j * np.array(numbers[1::2])))
    return polygons, circles


def stepped(piece):
    """A start, and the steps to the middle and to the end of each arc, and along each straight edge."""
    steps = []
    for sort, text in re.findall(r"([Mla])([^Mlaz]*)", piece):
        numbers = [float(n) for n in re.findall(NUMBER, text)]
        if sort != "a":
            steps += [complex(x, y) for x, y in zip(numbers[::2], numbers[1::2])]
            continue
        for radius, _, _, _, turns, x, y in zip(*[iter(numbers)] * 7):
            chord = complex(x, y)
            high = radius - max(radius**2 - abs(chord) ** 2 / 4, 0) ** 0.5
            bow = (-1j if turns else 1j) * chord / abs(chord) * high
            steps += [chord / 2 + bow, chord / 2 - bow]
    return np.array(steps)


def root_of(content):
    return ET.fromstring(content.decode())


def titled(root, name):
    """The group of a body or a mark by its title."""
    parents = {child: parent for parent in root.iter() for child in parent}
    return next(
        parents[title]
        for title in root.iter(f"{SPACE}title")
        if title.text == name and parents[title].tag == f"{SPACE}g"
    )


def motions(root):
    """Of each moving class: shares of a pass (n,), and its transforms as numbers (n, 4): x, y, turn in deg, opacity."""
    style = root.find(f"{SPACE}style").text
    found = {}
    for name, inside in re.findall(r"@keyframes (\w+)\{((?:[\d.]+%\{[^}]*\})*)\}", style):
        rows = []
        for share, rule in re.findall(r"([\d.]+)%\{([^}]*)\}", inside):
            moved = re.search(rf"translate\(({NUMBER})px,({NUMBER})px\)", rule)
            turned = re.search(rf"rotate\(({NUMBER})deg\)", rule)
            shown = re.search(r"opacity:(\d)", rule)
            rows.append(
                [
                    float(share) / 100,
                    *map(float, moved.groups()),
                    float(turned[1]) if turned else 0.0,
                    float(shown[1]) if shown else 1.0,
                ]
            )
        found[name] = np.array(rows)
    return found


def pose_at(rows, share):
    """Place and turn of a motion at a share of the pass, as a browser has them: straight between key frames."""
    x, y, turn = (np.interp(share, rows[:, 0], rows[:, k]) for k in (1, 2, 3))
    return x + 1j * y, np.exp(1j * np.radians(turn))
