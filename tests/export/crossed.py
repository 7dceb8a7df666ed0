"""Sections of meshes, triangle by triangle."""

import numpy as np
import shapely


def section(corners, height):
    """Segments (n, 2) complex in which triangles (m, 3, 3) cross a height; neighbours end in the very same places."""
    z, above = corners[..., 0] + 1j * corners[..., 1], corners[..., 2] > height
    crossed = above.any(axis=1) & ~above.all(axis=1)
    z, h, above = z[crossed], corners[crossed, :, 2], above[crossed]
    # The corner that is alone on its side, and the two others.
    alone = np.argmax(above == (above.sum(axis=1) == 1)[:, None], axis=1)
    row, ends = np.arange(len(z)), []
    for step in (1, 2):
        other = (alone + step) % 3
        low, high = np.where(above[row, alone], [other, alone], [alone, other])
        share = (height - h[row, low]) / (h[row, high] - h[row, low])
        ends.append(z[row, low] + share * (z[row, high] - z[row, low]))
    return np.stack(ends, axis=1)


def region(corners, height):
    """The area that a mesh has at a height: that within its outermost ring, less the others."""
    lines = np.stack([(z := section(corners, height)).real, z.imag], axis=-1)
    rings = shapely.get_parts(shapely.polygonize(shapely.linestrings(lines)))
    outer, *inner = sorted((shapely.Polygon(one.exterior) for one in rings), key=lambda one: -one.area)
    return outer.difference(shapely.union_all(inner))
