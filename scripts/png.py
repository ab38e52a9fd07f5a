"""8-bit RGB and RGBA pictures: what halve_png.py and shrink_png.py read and write."""
import struct
import zlib


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
    """Width, height, bytes a pixel, and rows of bytes; nothing if it has a palette."""
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
    return width, height, n, unfiltered(zlib.decompress(packed), width, height, n)


def write(path, width, height, colour, lines, palette=b""):
    """`lines`: rows, each behind the byte of its filter; `colour`: 2 is RGB, 3 the numbers of a palette."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, colour, 0, 0, 0)) +
                   (chunk(b"PLTE", palette) if palette else b"") + chunk(b"IDAT", zlib.compress(bytes(lines), 9)) +
                   chunk(b"IEND", b""))
