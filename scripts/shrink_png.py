#!/usr/bin/env python3
"""Rewrites 8-bit RGB or RGBA pictures with at most 256 colours, in place: shrink_png.py FILE.png...
Pictures that have a palette already are left alone."""
import struct
import sys
import zlib
from collections import Counter


def unfiltered(raw, width, height, n):
    rows, above = [], bytearray(width * n)
    for y in range(height):
        start = y * (width * n + 1)
        kind, row = raw[start], bytearray(raw[start + 1:start + 1 + width * n])
        if kind == 2:
            row = bytearray((a + b) & 255 for a, b in zip(row, above))
        elif kind:
            for i in range(len(row)):
                left, up = row[i - n] if i >= n else 0, above[i]
                corner = above[i - n] if i >= n else 0
                if kind == 1:
                    row[i] = (row[i] + left) & 255
                elif kind == 3:
                    row[i] = (row[i] + (left + up) // 2) & 255
                else:
                    p = left + up - corner
                    a, b, c = abs(p - left), abs(p - up), abs(p - corner)
                    row[i] = (row[i] + (left if a <= b and a <= c else up if b <= c else corner)) & 255
        rows.append(row)
        above = row
    return rows


def read(path):
    """Width, height and pixels as (r, g, b); nothing if it has a palette."""
    data = open(path, "rb").read()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    if colour == 3:
        return None
    assert depth == 8 and colour in (2, 6), f"{path}: not 8-bit RGB(A)"
    n = 3 if colour == 2 else 4
    rows = unfiltered(zlib.decompress(packed), width, height, n)
    return width, height, [list(zip(row[0::n], row[1::n], row[2::n])) for row in rows]


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


def write(path, width, height, palette, lines):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    raw = b"".join(b"\0" + bytes(line) for line in lines)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)) +
                   chunk(b"PLTE", b"".join(bytes(c) for c in palette)) + chunk(b"IDAT", zlib.compress(raw, 9)) +
                   chunk(b"IEND", b""))


for path in sys.argv[1:]:
    picture = read(path)
    if picture is None:
        continue
    width, height, rows = picture
    coarse = [[(r & 0xfc, g & 0xfc, b & 0xfc) if min(r, g, b) < 252 else (255, 255, 255) for r, g, b in row] for row in rows]
    palette, index = palette_of(Counter(c for row in coarse for c in row))
    write(path, width, height, palette, [[index[c] for c in row] for row in coarse])
