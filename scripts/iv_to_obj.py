"""Writes the triangles of a binary Open Inventor 2.1 file as OBJ.

usage: iv_to_obj.py IN.iv OUT.obj

Reads only what flat files of IndexedTriangleStripSets without transforms need: each shape is a field `vertex`, then a
field `coordIndex`. Big-endian; a name is a 4-byte length and its bytes, padded with zeros to a multiple of 4; an array
field is its name, a 4-byte count and the values.
"""

import struct
import sys

VERTEX = struct.pack(">I", 6) + b"vertex\0\0"
INDEX = struct.pack(">I", 10) + b"coordIndex\0\0"


def read_array(data, field, start, item):
    """The values of the next `field` at or after `start` and where they end; (None, start) if there is none."""
    at = data.find(field, start)
    if at < 0:
        return None, start
    at += len(field)
    (count,) = struct.unpack_from(">I", data, at)
    end = at + 4 + count * struct.calcsize(item)
    return list(struct.iter_unpack(item, data[at + 4:end])), end


def triangles_of(strip):
    for i in range(len(strip) - 2):
        a, b, c = strip[i:i + 3]
        yield (a, b, c) if i % 2 == 0 else (b, a, c)


def convert(data):
    lines = []
    base = 1  # OBJ counts from 1
    at = 0
    while True:
        vertices, at = read_array(data, VERTEX, at, ">3f")
        if vertices is None:
            return lines
        indices, at = read_array(data, INDEX, at, ">i")
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
        strip = []
        for (index,) in [*indices, (-1,)]:
            if index >= 0:
                strip.append(index + base)
                continue
            lines += [f"f {a} {b} {c}" for a, b, c in triangles_of(strip)]
            strip = []
        base += len(vertices)


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__)
    with open(arguments[0], "rb") as file:
        lines = convert(file.read())
    with open(arguments[1], "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
