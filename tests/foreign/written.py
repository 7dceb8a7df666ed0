"""Files of other programs, written here by their formats, and where their joints go, by Newton's method on distances."""

import itertools
import json

import numpy as np

# Linkages as joints (fixed ones in capitals), links, the driver's pivot and crank pin, and slots: pin, guide.
FOUR_BAR = (
    {"O": 0j, "C": 10 + 0j, "a": 1 + 2.5j, "b": 8.5 + 6j, "p": 4 + 8j},
    {"crank": "Oa", "coupler": "abp", "rocker": "bC"},
    ("O", "a"),
    {},
)
SLIDER_CRANK = (
    {"O": 0j, "a": 2 + 1.5j, "s": 9 + 1j, "F": 5 + 1j, "G": 12 + 1j},
    {"crank": "Oa", "rod": "as"},
    ("O", "a"),
    {"s": ("F", "G")},
)
QUICK_RETURN = (
    {"O": 0j, "C": -6j, "a": 2.5 + 1j, "t": (2.5 + 7j) * 2 - 6j},
    {"crank": "Oa", "lever": "Ct"},
    ("O", "a"),
    {"a": ("C", "t")},
)
SIX_BAR = (
    {"O": 0j, "C": 9 + 0j, "F": 13 + 3j, "a": 1 + 2j, "b": 8 + 6j, "p": 4.5 + 7.5j, "q": 11 + 9j},
    {"crank": "Oa", "coupler": "abp", "rocker": "bC", "link": "pq", "output": "qF"},
    ("O", "a"),
    {},
)
# No two links make a dyad: the plate on three legs.
SIEVE = (
    {"O": 0j, "C": 13 + 0j, "D": 19 + 11j, "a": 1.5 + 0j, "p": 0.4 + 7.9j, "q": 13.3 + 7.5j, "r": 7.2 + 11.7j},
    {"crank": "Oa", "push": "ap", "sieve": "pqr", "leg": "qC", "arm": "rD"},
    ("O", "a"),
    {},
)
ALL = {
    "four-bar": FOUR_BAR,
    "slider-crank": SLIDER_CRANK,
    "quick return": QUICK_RETURN,
    "six-bar": SIX_BAR,
    "sieve": SIEVE,
}


def pylinkage(linkage, unit=1.0):
    """JSON of `mechanism_to_json`; a slide has its line in the frame."""
    joints, links, (pivot, pin), slots = linkage
    rows = []
    for id, z in joints.items():
        row = {"id": id, "type": "ground" if id.isupper() else "revolute", "position": [z.real * unit, z.imag * unit]}
        if id in slots:
            one, two = (joints[limit] * unit for limit in slots[id])
            row |= {
                "type": "prismatic",
                "axis": [(two - one).real, (two - one).imag],
                "line_point": [one.real, one.imag],
            }
        rows.append(row)
    bodies = [{"id": "ground", "type": "ground", "joints": [id for id in joints if id.isupper()]}]
    for name, named in links.items():
        drives = (
            {"type": "driver", "motor_joint": pivot, "angular_velocity": 0.1}
            if pin in named and pivot in named
            else {"type": "link"}
        )
        bodies.append({"id": name, "joints": list(named), **drives})
    return json.dumps({"name": "drawn", "joints": rows, "links": bodies, "ground": "ground"})


DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"


def base_64(number):
    text, rest = "", abs(round(number))
    while rest or not text:
        text, rest = DIGITS[rest % 64] + text, rest // 64
    return "0" + text if number < 0 else text


def pmks(linkage, clockwise=False, forces=""):
    """A link of PMKS+ with lengths in cm; a piston holds the pin and the slide of a slot."""
    joints, links, (pivot, _), slots = linkage
    text = ("0P" if clockwise else "0O") + ".TY.K,0.101."
    rows, bodies = "", ""
    guides = set(slots.values())
    for id, z in joints.items():
        if (
            id.isupper()
            and id != pivot
            and any(id in pair for pair in guides)
            and not any(id in named for named in links.values())
        ):
            continue
        bits = 2 * (id == pivot) + 4 * id.isupper()
        rows += f"{DIGITS[bits]}{id},{id},{base_64(1000 * z.real)},{base_64(1000 * z.imag)},0."
    held = dict(links)
    for pin, (one, two) in slots.items():
        slide, z, line = f"{pin}x", joints[pin], joints[two] - joints[one]
        in_frame = one.isupper() and two.isupper()
        bits = 1 + 4 * in_frame
        angle = base_64(1000 * np.angle(line))
        rows += f"{DIGITS[bits]}{slide},{slide},{base_64(1000 * z.real)},{base_64(1000 * z.imag)},{angle}."
        if not in_frame:
            guide = next(name for name, named in held.items() if one in named and two in named)
            held[guide] = [*held[guide], slide]
        bodies += f"YP{pin}{slide},{pin}{slide},Fe,0,0,0,,{pin},{slide},,."
    for name, named in held.items():
        bodies += f"YR{name},{name},Fe,Fe,0,0,c5cae9,{','.join(named)},,."
    text += f"{rows}.{bodies}.{forces}.N_"
    return f"https://app.pmksplus.com/?{text}{DIGITS[len(text) % 62]}"


def linkage2(linkage, unit=10 * 96 / 25.4, more="", of_link=""):
    """XML of the program Linkage; `unit` of the drawing in 1/96 inch."""
    joints, links, (pivot, _), slots = linkage
    number = {id: k for k, id in enumerate(joints)}
    lines = ['<linkage2>\n\t<program zoom="1" xoffset="268" yoffset="166" scalefactor="1" units="Millimeters"/>']
    for id, z in joints.items():
        text = f'\t<connector id="{number[id]}" layer="16" x="{z.real * unit:.6f}" y="{z.imag * unit:.6f}"'
        text += ' anchor="true"' * id.isupper() + ' input="true" rpm="-30"' * (id == pivot)
        if id in slots:
            limits = "".join(f'\n\t\t<slidelimit id="{number[limit]}"/>' for limit in slots[id])
            text += f' slider="true">{limits}\n\t</connector>'
        else:
            text += "/>"
        lines.append(text)
    for k, named in enumerate(links.values()):
        inner = "".join(f'\n\t\t<connector id="{number[id]}"/>' for id in named)
        lines.append(f'\t<Link id="{k}" layer="16"{of_link}>{inner}\n\t</Link>')
    return "\n".join([*lines, more, "</linkage2>"])


def positions(linkage, turn):
    """Positions of all joints, (turns, joints), as the crank turns from the drawing: small steps, least squares."""
    joints, links, (pivot, pin), slots = linkage
    free = [id for id in joints if not id.isupper() and id != pin]
    at, found = dict(joints), []
    distances = [
        (one, two, abs(joints[one] - joints[two]))
        for named in links.values()
        for one, two in itertools.combinations(named, 2)
    ]

    def missing(values):
        z = at | dict(zip(free, values[::2] + 1j * values[1::2]))
        lengths = [abs(z[one] - z[two]) - length for one, two, length in distances]
        offsets = []
        for slid, (one, two) in slots.items():
            line = z[two] - z[one]
            offsets.append(((z[slid] - z[one]) * np.conj(line)).imag / abs(line))
        return np.array(lengths + offsets)

    for step in turn:
        at[pin] = joints[pivot] + (joints[pin] - joints[pivot]) * np.exp(1j * step)
        values = np.array([part for id in free for part in (at[id].real, at[id].imag)])
        for _ in range(8):
            off = missing(values)
            slope = np.array([(missing(values + 1e-7 * row) - off) / 1e-7 for row in np.eye(len(values))]).T
            values = values - np.linalg.lstsq(slope, off, rcond=None)[0]
        at |= dict(zip(free, values[::2] + 1j * values[1::2]))
        found.append([at[id] for id in joints])
    return np.array(found)
