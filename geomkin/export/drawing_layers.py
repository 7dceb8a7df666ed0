"""Names and colours of the layers of DXF and SVG drawings."""

# Layer of each operation -> a colour index, for programs without RGB, and an RGB colour that colour-blind readers can
# distinguish.
LAYERS: dict[str, tuple[int, tuple[int, int, int]]] = {
    "CUT": (1, (213, 94, 0)),
    "HOLE": (5, (0, 114, 178)),
    "ENGRAVE": (3, (0, 158, 115)),
    "LABEL": (6, (204, 121, 167)),
    "REFERENCE": (8, (110, 110, 110)),
}
