"""Pictures, meshes and tables that claim more than they hold, or hold more than they seem to, each beside a scene that reads it.

What is `refused-*` is to be an error; `read-*` is as large as it may be, and fine. Usage: hostile.py, in an empty folder.
"""

import pathlib
import random
import struct
import zlib

MANY = 4_000_000_000
# The most pixels there may be, in rows that all the formats can have.
WIDE, HIGH = 8192, 4096


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def zeros(count):
    """Zeros, deflated: a thousandth of what they are."""
    packer, block = zlib.compressobj(9), bytes(1 << 20)
    parts = [packer.compress(block) for _ in range(count >> 20)] + [packer.compress(bytes(count & (1 << 20) - 1))]
    return b"".join(parts) + packer.flush()


def png(width, height, depth, color, *between, data):
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, color, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + b"".join(between) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def exr(width, height, compression, payload):
    attribute = lambda name, kind, data: name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data
    channels = b"".join(name + b"\0" + struct.pack("<IB3xII", 1, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    return (
        b"\x76\x2f\x31\x01\x02\0\0\0"
        + attribute(b"channels", b"chlist", channels)
        + attribute(b"compression", b"compression", bytes([compression]))
        + attribute(b"dataWindow", b"box2i", window)
        + attribute(b"displayWindow", b"box2i", window)
        + attribute(b"lineOrder", b"lineOrder", b"\0")
        + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
        + attribute(b"screenWindowCenter", b"v2f", bytes(8))
        + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
        + b"\0"
        + payload
    )


def exr_blocks(head, width, height):
    """Sixteen rows of black halves a block, deflated: what is kept is by how much a byte exceeds the last, and 128."""
    packed = zlib.compress(b"\0" + b"\x80" * (16 * width * 3 * 2 - 1), 9)
    count = height // 16
    size = 8 + len(packed)
    start = len(head) + 8 * count
    table = b"".join(struct.pack("<Q", start + size * i) for i in range(count))
    return table + b"".join(struct.pack("<iI", 16 * i, len(packed)) + packed for i in range(count))


def hdr(width, height, data):
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"-Y {height} +X {width}\n".encode() + data


def hdr_row(width):
    """A row of black in runs."""
    runs = bytes([128 + 127, 0]) * (width // 127) + (bytes([128 + width % 127, 0]) if width % 127 else b"")
    return bytes([2, 2, width >> 8, width & 255]) + 4 * runs


def jpeg(width, height):
    """A head without what it speaks of."""
    parts = b"".join(bytes([i, 0x11, 0]) for i in (1, 2, 3))
    frame = struct.pack(">BHHB", 8, height, width, 3) + parts
    return b"\xff\xd8\xff\xc2" + struct.pack(">H", len(frame) + 2) + frame + b"\xff\xd9"


def webp(kind, data):
    body = b"WEBP" + kind + struct.pack("<I", len(data)) + data + bytes(len(data) & 1)
    return b"RIFF" + struct.pack("<I", len(body)) + body


def ply(form, elements, data):
    heads = "".join(f"element {name} {count}\n" + "".join(f"property {p}\n" for p in properties) for name, count, properties in elements)
    return f"ply\nformat {form} 1.0\n{heads}end_header\n".encode() + data


def pictures():
    rows = zeros(HIGH * (1 + 3 * WIDE))
    bomb = zeros(1 << 30)
    yield "refused-claims.png", png(100000, 100000, 8, 2, data=rows)
    yield "refused-longest.png", png(2**31 - 1, 2**31 - 1, 16, 6, data=b"")
    yield "refused-empty.png", png(WIDE, HIGH, 16, 6, data=zlib.compress(b""))
    yield "read-bomb.png", png(1, 1, 8, 2, data=bomb)
    yield "any-profile.png", png(1, 1, 8, 2, chunk(b"iCCP", b"x\0\0" + bomb), data=zlib.compress(bytes(4)))
    yield "any-text.png", png(1, 1, 8, 2, chunk(b"zTXt", b"x\0\0" + bomb), data=zlib.compress(bytes(4)))
    yield "read-most.png", png(WIDE, HIGH, 8, 2, data=rows)
    yield "read-deepest.png", png(WIDE, HIGH, 16, 2, data=zeros(HIGH * (1 + 6 * WIDE)))
    yield "refused-claims.exr", exr(100000, 100000, 3, b"")
    yield "refused-longest.exr", exr(2**31 - 1, 2**31 - 1, 0, b"")
    yield "refused-empty.exr", exr(WIDE, HIGH, 3, b"")
    yield "refused-offsets.exr", exr(WIDE, HIGH, 0, b"\xff" * (8 * HIGH))
    most = exr(WIDE, HIGH, 3, b"")
    yield "read-most.exr", most + exr_blocks(most, WIDE, HIGH)
    yield "refused-claims.hdr", hdr(100000, 100000, b"")
    yield "refused-longest.hdr", hdr(2**64 - 1, 2**64 - 1, b"")
    yield "refused-empty.hdr", hdr(WIDE, HIGH, b"")
    yield "refused-repeats.hdr", hdr(WIDE, HIGH, bytes([1, 1, 1, 255]) * 64)
    yield "read-most.hdr", hdr(WIDE, HIGH, hdr_row(WIDE) * HIGH)
    yield "refused-claims.jpg", jpeg(65535, 65535)
    yield "refused-empty.jpg", jpeg(WIDE, HIGH)
    yield "refused-claims.webp", webp(b"VP8X", b"\0" * 4 + b"\xff" * 6)
    yield "refused-lossless.webp", webp(b"VP8L", b"\x2f\xff\xff\xff\x0f" + bytes(64))
    yield "refused-lossy.webp", webp(b"VP8 ", b"\x10\0\0\x9d\x01\x2a\xff\x3f\xff\x3f" + bytes(64))
    chance = random.Random(1)
    for name, magic in [("png", b"\x89PNG\r\n\x1a\n"), ("exr", b"\x76\x2f\x31\x01\x02\0\0\0"), ("hdr", b"#?RADIANCE\n"), ("jpg", b"\xff\xd8\xff\xe0"), ("webp", b"RIFF\xff\xff\0\0WEBP")]:
        yield f"refused-noise.{name}", magic + chance.randbytes(1 << 16)


def meshes():
    corner = ["float x", "float y", "float z"]
    face = ["list uchar int vertex_indices"]
    for form in ["ascii", "binary_little_endian", "binary_big_endian"]:
        yield f"refused-claims-{form}.ply", ply(form, [("vertex", MANY, corner), ("face", MANY, face)], b"0 0 0\n")
        yield f"refused-empty-{form}.ply", ply(form, [("vertex", 4, corner), ("face", MANY, face)], b"0 0 0\n" * 4)
    corners = ["list uint int vertex_indices"]
    yield "refused-corners.ply", ply("binary_little_endian", [("face", 1, corners)], b"\xff" * 64)
    yield "refused-faces.ply", ply("binary_little_endian", [("face", 1 << 27, ["list uchar uchar vertex_indices"])], bytes(1 << 27))
    yield "refused-vertices.ply", ply("binary_little_endian", [("vertex", 1 << 27, ["char x"])], bytes(1 << 27))
    yield "refused-others.ply", ply("binary_little_endian", [("other", 1 << 27, ["list uchar uchar what"])], bytes(1 << 27))
    yield "refused-faces.obj", b"v 0 0 0\n" + b"f 1 1 1\n" * (11 << 20)
    yield "refused-index.obj", b"v 0 0 0\nf 1 2 4000000000\nf -4000000000 1 1\n"
    yield "refused-noise.obj", random.Random(2).randbytes(1 << 16)


def tables():
    yield "refused-rows.csv", b"x\n" + b"1\n" * 20_000_001
    yield "refused-columns.csv", b"x\n" + b"," * 1_000_000
    yield "refused-noise.csv", random.Random(3).randbytes(1 << 16)


def main():
    reads = [
        (pictures, 'sky {{ image: "{}" }}\nsphere {{ radius: 1m }}\n'),
        (meshes, 'mesh {{ file: "{}" }}\n'),
        (tables, 'for row in table("{}") {{ sphere {{ radius: 1m * row.x }} }}\n'),
    ]
    for files, scene in reads:
        for name, data in files():
            pathlib.Path(name).write_bytes(data)
            pathlib.Path(name + ".rt").write_text(scene.format(name))


main()
