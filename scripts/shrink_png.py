#!/usr/bin/env python3
"""Rewrites 8-bit RGB or RGBA pictures with at most 256 colours, in place: shrink_png.py FILE.png...
Pictures that have a palette already are left alone."""
import sys
from collections import Counter

import png


def palette_of(counts):
    """At most 256 colours: boxes of colours, the one of the greatest spread by number is parted at its median."""
    boxes = [list(counts)]
    while len(boxes) < 256:
        def spread(box):
            sides = [max(c[k] for c in box) - min(c[k] for c in box) for k in range(3)]
            return max(sides), sides.index(max(sides))
        scored = [(spread(box)[0] * sum(counts[c] for c in box)**0.5, i) for i, box in enumerate(boxes) if len(box) > 1]
        if not scored:
            break
        _, i = max(scored)
        box = boxes.pop(i)
        k = spread(box)[1]
        box.sort(key=lambda c: c[k])
        middle = (box[0][k] + box[-1][k]) / 2
        cut = next(j for j, c in enumerate(box) if c[k] > middle)
        boxes += [box[:cut], box[cut:]]
    palette, index = [], {}
    for box in boxes:
        # The commonest colour stands for its box, so that plain areas and text keep theirs.
        palette.append(max(box, key=lambda c: counts[c]))
        for c in box:
            index[c] = len(palette) - 1
    return palette, index


for path in sys.argv[1:]:
    picture = png.read(path)
    if picture is None:
        continue
    width, height, n, rows = picture
    pixels = [list(zip(row[0::n], row[1::n], row[2::n])) for row in rows]
    coarse = [[(r & 0xfc, g & 0xfc, b & 0xfc) if min(r, g, b) < 252 else (255, 255, 255) for r, g, b in row] for row in pixels]
    palette, index = palette_of(Counter(c for row in coarse for c in row))
    lines = b"".join(b"\0" + bytes(index[c] for c in row) for row in coarse)
    png.write(path, width, height, 3, lines, b"".join(bytes(c) for c in palette))
