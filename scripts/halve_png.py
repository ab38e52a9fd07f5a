#!/usr/bin/env python3
"""Halves the side of 8-bit RGB or RGBA pictures, in place: halve_png.py FILE.png..."""
import struct
import sys
import zlib


def read(path):
    data = open(path, "rb").read()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert depth == 8 and colour in (2, 6), f"{path}: not 8-bit RGB(A)"
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    n = 3 if colour == 2 else 4
    raw, rows, above = zlib.decompress(packed), [], bytearray(width * n)
    for y in range(height):
        start = y * (width * n + 1)
        kind, row = raw[start], bytearray(raw[start + 1:start + 1 + width * n])
        for i in range(len(row)):
            left, up = row[i - n] if i >= n else 0, above[i]
            corner = above[i - n] if i >= n else 0
            if kind == 1:
                row[i] = (row[i] + left) & 255
            elif kind == 2:
                row[i] = (row[i] + up) & 255
            elif kind == 3:
                row[i] = (row[i] + (left + up) // 2) & 255
            elif kind == 4:
                p = left + up - corner
                a, b, c = abs(p - left), abs(p - up), abs(p - corner)
                row[i] = (row[i] + (left if a <= b and a <= c else up if b <= c else corner)) & 255
        rows.append(row)
        above = row
    return width, height, n, rows


def write(path, width, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    lines = bytearray()
    above = bytearray(3 * width)
    for row in rows:  # each less the one above: smooth pictures pack well
        lines.append(2)
        lines += bytes((a - b) & 255 for a, b in zip(row, above))
        above = row
    header = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(lines), 9)) +
                   chunk(b"IEND", b""))


for path in sys.argv[1:]:
    width, height, n, rows = read(path)
    half = []
    for y in range(0, height - 1, 2):
        a, b, out = rows[y], rows[y + 1], bytearray()
        for x in range(0, (width - 1) * n, 2 * n):
            out += bytes((a[x + k] + a[x + n + k] + b[x + k] + b[x + n + k] + 2) // 4 for k in range(3))
        half.append(out)
    write(path, width // 2, half)
