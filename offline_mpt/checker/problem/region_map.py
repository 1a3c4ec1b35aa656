"""The parts of a region map (region_maps/FORMAT.md) that are compared with its problem. Its search tree is not."""
import struct
from fractions import Fraction
from math import isfinite

from exact import require
from files import xxh64

# Greatest tolerance of a map, see region_maps/FORMAT.md.
MOST_TOLERANCE = 1e-8
# By how much the length of a plane may differ from 1.
MOST_LENGTH_ERROR = Fraction(1, 1 << 40)
MOST_SIGNALS = 256
HEAD_BYTES = {1: 256, 2: 272}
CHECKSUM = slice(24, 32)
FIRST_SECTION = 96
# Name, problem, kind, status and notes come before the names and units of signals.
WORDS_BEFORE_SIGNALS = 5


class Region:
    """Rows from first_row on, and a law."""

    def __init__(self, first_row, row_count, law, _first_active, active_count):
        self.first_row, self.row_count, self.law, self.active_count = first_row, row_count, law, active_count


class RegionMap:
    """Signed rows name planes from 1 on; laws have a row for each input. Rows and planes are doubles."""

    def __init__(self, content):
        require(len(content) >= HEAD_BYTES[1] and content.startswith(b"PFLYMAP\n"), "not a region map")
        self._content = content
        order, version, self.size, self.checksum = self._head("<IIQQ", 8)
        require(order == 0x01020304, "the byte order of the map is unknown")
        require(version in HEAD_BYTES, "the version of the map is unknown")
        require(self.size == len(content) >= HEAD_BYTES[version], "the map is cut off")
        blank = content[:CHECKSUM.start] + bytes(8) + content[CHECKSUM.stop:]
        require(xxh64(blank) == self.checksum, "the map is damaged: its checksum does not match")
        self.p, self.q = self._head("<II", 32)
        self.period, self.tolerance = self._head("<dd", 48)
        self.reduced_from, fallbacks, reserved = self._head("<QII", 80)
        require(0 <= self.tolerance <= MOST_TOLERANCE, "the map's tolerance is out of range")
        require(fallbacks == 0, "the map has fallback regions: reduce the original map again")
        require(reserved == 0, "the reserved bytes of the map are not zero")
        require(1 <= self.p <= MOST_SIGNALS and 1 <= self.q <= MOST_SIGNALS, "the map's sizes are out of range")
        self._read_text()
        self._read_tables()
        self._check_lengths()

    def _head(self, layout, at):
        return struct.unpack_from(layout, self._content, at)

    def _section(self, index, layout):
        """Items of a section."""
        offset, count = self._head("<QQ", FIRST_SECTION + 16 * index)
        width = struct.calcsize(layout)
        require(offset <= len(self._content) and count <= (len(self._content) - offset) // width,
                "a section of the map lies outside of it")
        return list(struct.iter_unpack(layout, self._content[offset:offset + count * width]))

    def _read_text(self):
        *words, end = b"".join(letter for letter, in self._section(0, "<c")).split(b"\0")
        require(not end and len(words) == WORDS_BEFORE_SIGNALS + 2 * (self.p + self.q),
                "the map's text is not as it must be")
        words = [word.decode("utf-8", "surrogateescape") for word in words]
        self.problem_bytes = words[1].encode("utf-8", "surrogateescape")
        self.problem, self.kind = words[1:3]
        self.names, self.units = words[WORDS_BEFORE_SIGNALS::2], words[WORDS_BEFORE_SIGNALS + 1::2]

    def _read_tables(self):
        width = self.p + 1
        self.bounds = self._section(1, "<2d")
        require(len(self.bounds) == self.p + self.q, "the map's bounds are not as they must be")
        self.planes = self._section(2, f"<{width}d")
        self.laws = [[law[width * j:width * (j + 1)] for j in range(self.q)]
                     for law in self._section(3, f"<{width * self.q}d")]
        self.regions = [Region(*numbers) for numbers in self._section(4, "<5I")]
        self.rows = [row for row, in self._section(5, "<i")]
        active_count = len(self._section(6, "<i"))
        require(all(0 < abs(row) <= len(self.planes) for row in self.rows), "a row of the map names no plane")
        for region in self.regions:
            require(region.first_row + region.row_count <= len(self.rows) and region.law < len(self.laws) and
                    region.active_count <= active_count, "a region of the map reaches beyond its tables")
        numbers = [*self.planes, *self.bounds[:self.p], *(row for law in self.laws for row in law)]
        require(all(map(isfinite, (number for row in numbers for number in row))),
                "the map has an entry that is no number")

    def _check_lengths(self):
        """Tolerances are distances only where every plane has the length 1 in scaled parameters."""
        half = [(Fraction(upper) - Fraction(lower)) / 2 for lower, upper in self.bounds[:self.p]]
        for plane in self.planes:
            squared = sum((width * Fraction(entry)) ** 2 for width, entry in zip(half, plane))
            require((1 - MOST_LENGTH_ERROR) ** 2 <= squared <= (1 + MOST_LENGTH_ERROR) ** 2,
                    "a plane of the map has another length than 1 in scaled parameters")
