"""Reads LAS 1.4 files with points of format 7 and checks them against the specification (ASPRS LAS 1.4 R15). Needs only Python's standard library.

  python3 las_reader.py FILE.las     prints what is in the file
  python3 las_reader.py --self-test
"""
import collections
import math
import struct
import sys

HEADER_BYTES = 375
RECORD_BYTES = 36  # of format 7, without extra bytes
WKT_RECORD = 2112
# x, y, z, intensity, returns, flags, class, user data, scan angle, source, GPS time, red, green, blue
RECORD = "iiiHBBBBhHdHHH"


class BadLas(Exception):
    pass


def require(condition, text):
    if not condition:
        raise BadLas(text)


class Las:
    """points: (x, y, z, class, user data, (red, green, blue)) in metres, the colours 16 bits. Throws BadLas for a file that breaks a rule."""

    def __init__(self, file):
        content = file if isinstance(file, bytes) else open(file, "rb").read()
        require(len(content) >= HEADER_BYTES, f"only {len(content)} bytes")
        require(content[:4] == b"LASF", f"starts with {content[:4]}")
        encoding, = struct.unpack_from("<H", content, 6)
        require(content[24] == 1 and content[25] == 4, f"version {content[24]}.{content[25]}, not 1.4")
        self.day, self.year, header_bytes, first, n_vlr = struct.unpack_from("<HHHII", content, 90)
        self.format, self.record_bytes = struct.unpack_from("<BH", content, 104)
        require(header_bytes == HEADER_BYTES, f"a header of {header_bytes} bytes")
        require(self.format == 7, f"points of format {self.format}, not 7")
        require(self.record_bytes >= RECORD_BYTES, f"records of {self.record_bytes} bytes")
        require(encoding & 16, "the bit of the global encoding for a WKT is not set, as it must be for formats from 6 on")
        require(not any(struct.unpack_from("<6I", content, 107)), "the old counts must be 0 for formats from 6 on")
        self.scale = struct.unpack_from("<3d", content, 131)
        self.offset = struct.unpack_from("<3d", content, 155)
        bounds = struct.unpack_from("<6d", content, 179)
        self.max, self.min = bounds[0::2], bounds[1::2]
        first_evlr, n_evlr, self.count = struct.unpack_from("<QIQ", content, 235)
        self.by_return = struct.unpack_from("<15Q", content, 255)
        require(all(math.isfinite(value) and value > 0.0 for value in self.scale), f"scales {self.scale}")
        end = first + self.count * self.record_bytes
        require(end <= len(content), f"{self.count} points do not fit into {len(content)} bytes")
        if n_evlr == 0:
            require(end == len(content), f"{len(content) - end} bytes after the last point")
        self.software = content[58:90].rstrip(b"\0").decode("ascii")
        self.records = self.read_records(content, header_bytes, n_vlr, first, extended=False)
        if n_evlr:
            self.records.update(self.read_records(content, first_evlr, n_evlr, len(content), extended=True))
        self.wkt = self.records.get(("LASF_Projection", WKT_RECORD), b"")
        require(not self.wkt or self.wkt.endswith(b"\0"), "the WKT does not end with a zero")
        self.wkt = self.wkt.rstrip(b"\0").decode("utf-8")
        self.points = self.read_points(content[first:end])

    @staticmethod
    def read_records(content, at, n, end, extended):
        """Variable length records by (user, number)."""
        found = {}
        head = 60 if extended else 54
        for _ in range(n):
            require(at + head <= end, "a variable length record is cut off")
            user, number = content[at + 2:at + 18].rstrip(b"\0").decode("ascii"), struct.unpack_from("<H", content, at + 18)[0]
            size = struct.unpack_from("<Q" if extended else "<H", content, at + 20)[0]
            require(at + head + size <= end, f"record {user} {number} of {size} bytes reaches into the points")
            found[user, number] = content[at + head:at + head + size]
            at += head + size
        return found

    def read_points(self, data):
        points = []
        returns = collections.Counter()
        low, high = [math.inf] * 3, [-math.inf] * 3
        whole = self.scale, self.offset
        for x, y, z, _, numbers, _, las_class, user, angle, _, _, red, green, blue in struct.iter_unpack(
                f"<{RECORD}{self.record_bytes - RECORD_BYTES}x", data):
            position = tuple(value * scale + offset for value, scale, offset in zip((x, y, z), *whole))
            returns[numbers & 15] += 1
            require(1 <= numbers & 15 <= numbers >> 4, f"return {numbers & 15} of {numbers >> 4}")
            require(abs(angle) <= 30000, f"scan angle {angle}")
            for axis in range(3):
                low[axis] = min(low[axis], position[axis])
                high[axis] = max(high[axis], position[axis])
            points.append((*position, las_class, user, (red, green, blue)))
        require(len(points) == self.count, f"{len(points)} points, the header says {self.count}")
        require(tuple(returns[i + 1] for i in range(15)) == self.by_return, f"counts by return {self.by_return}, found {dict(returns)}")
        for axis in range(3 if points else 0):
            slack = 1.01 * self.scale[axis]
            require(abs(low[axis] - self.min[axis]) <= slack and abs(high[axis] - self.max[axis]) <= slack,
                    f"axis {axis} is {low[axis]} to {high[axis]}, the header says {self.min[axis]} to {self.max[axis]}")
        return points

    def classes(self):
        return dict(collections.Counter(point[3] for point in self.points))


def made(points, wkt='PROJCS["WGS 84 / UTM zone 32N"]', version=4, format_=7, encoding=17, by_return=None):
    """A small file of (x, y, z, class, views, rgb), for self-tests."""
    text = wkt.encode() + b"\0"
    vlr = struct.pack("<H16sHH32s", 0, b"LASF_Projection", WKT_RECORD, len(text), b"WKT") + text
    offset = [math.floor(min(p[axis] for p in points)) for axis in range(3)]
    raw = [[round((p[axis] - offset[axis]) * 1000) for axis in range(3)] for p in points]
    values = [[value[axis] * 0.001 + offset[axis] for value in raw] for axis in range(3)]
    header = struct.pack("<4sHH16sBB32s32sHHHIIBH6I", b"LASF", 0, encoding, bytes(16), 1, version, b"OTHER", b"self-test", 100, 2024, HEADER_BYTES,
                         HEADER_BYTES + len(vlr), 1, format_, RECORD_BYTES, *[0] * 6)
    header += struct.pack("<3d3d", 0.001, 0.001, 0.001, *offset) + struct.pack("<6d", *(v for axis in values for v in (max(axis), min(axis))))
    header += struct.pack("<QQIQ15Q", 0, 0, 0, len(points), len(points) if by_return is None else by_return, *[0] * 14)
    assert len(header) == HEADER_BYTES
    body = b"".join(struct.pack("<" + RECORD, *r, 0, 0x11, 0, p[3], p[4], 0, 0, 0.0, *p[5]) for r, p in zip(raw, points))
    return header + vlr + body


EXAMPLE = [(465000.125, 5247000.5, 410.25, 2, 7, (65535, 0, 257)), (465010.0, 5247020.75, 418.0, 1, 3, (0, 32896, 65535)),
           (464999.75, 5246990.0, 409.5, 2, 9, (257, 257, 257))]


def refused(content):
    try:
        Las(content)
    except (BadLas, struct.error):
        return True
    return False


def self_test():
    file = made(EXAMPLE)
    las = Las(file)
    assert las.count == 3 and las.classes() == {2: 2, 1: 1} and las.wkt.startswith("PROJCS")
    for point, wanted in zip(las.points, EXAMPLE):
        assert all(abs(a - b) < 1e-6 for a, b in zip(point[:3], wanted[:3])) and point[3:] == wanted[3:], point
    assert refused(file[:-1]) and refused(file + b"\0") and refused(b"LASX" + file[4:])
    assert refused(made(EXAMPLE, version=3)) and refused(made(EXAMPLE, format_=3)) and refused(made(EXAMPLE, encoding=1))
    assert refused(made(EXAMPLE, by_return=2))
    wrong = bytearray(file)
    wrong[-RECORD_BYTES:-RECORD_BYTES + 4] = struct.pack("<i", 99999)  # a point outside the bounds
    assert refused(bytes(wrong))
    print("las_reader: passed")


if __name__ == "__main__":
    if sys.argv[1:] == ["--self-test"]:
        self_test()
    else:
        for name in sys.argv[1:]:
            of_file = Las(name)
            print(f"{name}: {of_file.count} points, {of_file.min} to {of_file.max}, classes {of_file.classes()}, {of_file.software}, {of_file.wkt}")
