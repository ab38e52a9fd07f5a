#!/usr/bin/env python3
"""Halves the side of 8-bit RGB or RGBA pictures, in place: halve_png.py FILE.png..."""
import sys

import png


def up_filtered(rows, width):
    """Each row less the one above: smooth pictures pack well."""
    lines, above = bytearray(), bytearray(3 * width)
    for row in rows:
        lines.append(2)
        lines += bytes((a - b) & 255 for a, b in zip(row, above))
        above = row
    return lines


for path in sys.argv[1:]:
    picture = png.read(path)
    assert picture, f"{path}: not 8-bit RGB(A)"
    width, height, n, rows = picture
    half = []
    for y in range(0, height - 1, 2):
        a, b, out = rows[y], rows[y + 1], bytearray()
        for x in range(0, (width - 1) * n, 2 * n):
            out += bytes((a[x + k] + a[x + n + k] + b[x + k] + b[x + n + k] + 2) // 4 for k in range(3))
        half.append(out)
    png.write(path, width // 2, len(half), 2, up_filtered(half, width // 2))
