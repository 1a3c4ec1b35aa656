"""The parts of a region map (region_maps/FORMAT.md) that are compared with its problem. Its search tree is not."""
import struct
from collections import namedtuple
from fractions import Fraction
from math import isfinite

from exact import require
from files import xxh64

# Greatest tolerance of a map, see region_maps/FORMAT.md.
MOST_TOLERANCE = 1e-8
# By how much the squared length of a plane may differ from 1.
MOST_LENGTH_ERROR = Fraction(1, 1 << 39)
MOST_SIGNALS = 256
HEAD_BYTES = {1: 256, 2: 272}
FIRST_SECTION = 96
# Name, problem, kind, status and notes come before the names and units of signals.
WORDS_BEFORE_SIGNALS = 5

Region = namedtuple("Region", "first_row row_count law first_active active_count")


class RegionMap:
    """Signed rows name planes from 1 on; laws have a row for each input. Numbers are fractions, but those of bounds, which may
    be infinite."""

    def __init__(self, content):
        require(len(content) >= HEAD_BYTES[1] and content.startswith(b"PFLYMAP\n"), "not a region map")
        self._content = content
        order, version, self.size, self.checksum = self._head("<IIQQ", 8)
        require(order == 0x01020304, "the byte order of the map is unknown")
        require(version in HEAD_BYTES, "the version of the map is unknown")
        require(self.size == len(content) >= HEAD_BYTES[version], "the map is cut off")
        require(xxh64(content[:24] + bytes(8) + content[32:]) == self.checksum,
                "the map is damaged: its checksum does not match")
        self.p, self.q = self._head("<II", 32)
        self.period, self.tolerance = self._head("<dd", 48)
        self.reduced_from, fallbacks, reserved = self._head("<QII", 80)
        require(0 <= self.tolerance <= MOST_TOLERANCE, "the map's tolerance is out of range")
        require(fallbacks == 0, "the map has fallback regions: reduce the original map again")
        require(reserved == 0, "the reserved bytes of the map are not zero")
        require(all(1 <= count <= MOST_SIGNALS for count in (self.p, self.q)), "the map's sizes are out of range")
        self._read_text()
        self._read_tables()

    def _head(self, layout, at):
        return struct.unpack_from(layout, self._content, at)

    def _section(self, index, layout):
        offset, count = self._head("<QQ", FIRST_SECTION + 16 * index)
        end = offset + count * struct.calcsize(layout)
        require(end <= len(self._content), "a section of the map lies outside of it")
        return list(struct.iter_unpack(layout, self._content[offset:end]))

    def _read_text(self):
        *words, end = b"".join(letter for letter, in self._section(0, "<c")).split(b"\0")
        require(not end and len(words) == WORDS_BEFORE_SIGNALS + 2 * (self.p + self.q),
                "the map's text is not as it must be")
        self.problem_bytes = words[1]
        words = [word.decode("utf-8", "surrogateescape") for word in words]
        (self.problem, self.kind), signals = words[1:3], words[WORDS_BEFORE_SIGNALS:]
        self.names, self.units = signals[::2], signals[1::2]

    def _numbers(self, index, count):
        rows = self._section(index, f"<{count}d")
        require(all(all(map(isfinite, row)) for row in rows), "the map has an entry that is no number")
        return [[*map(Fraction, row)] for row in rows]

    def _read_tables(self):
        width = self.p + 1
        self.bounds = self._section(1, "<2d")
        require(len(self.bounds) == self.p + self.q, "the map's bounds are not as they must be")
        require(all(-float("inf") < lower < upper < float("inf") for lower, upper in self.bounds[:self.p]),
                "a parameter has no range")
        self.box = [[*map(Fraction, ends)] for ends in self.bounds[:self.p]]
        self.planes = self._numbers(2, width)
        starts, laws = range(0, self.q * width, width), self._numbers(3, self.q * width)
        self.laws = [[law[at:at + width] for at in starts] for law in laws]
        self.regions = [Region(*numbers) for numbers in self._section(4, "<5I")]
        self.rows = [row for row, in self._section(5, "<i")]
        require(all(0 < abs(row) <= len(self.planes) for row in self.rows), "a row of the map names no plane")
        require(all(region.first_row + region.row_count <= len(self.rows) and region.law < len(self.laws)
                    for region in self.regions), "a region of the map reaches beyond its tables")
        # Tolerances are distances only where every plane has the length 1 in scaled parameters.
        for plane in self.planes:
            squared = sum(((ends[1] - ends[0]) / 2 * entry) ** 2 for ends, entry in zip(self.box, plane))
            require(abs(squared - 1) <= MOST_LENGTH_ERROR,
                    "a plane of the map has another length than 1 in scaled parameters")
