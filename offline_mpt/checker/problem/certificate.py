"""The program of a certificate, by the lines that state it (offline_mpt/CERTIFICATE.md). Its proofs are
check_certificate's."""
import re
from collections import namedtuple
from fractions import Fraction

from exact import Refused, require
from files import unsealed, xxh64

TITLE, ROBUST_TITLE = "polyfly certificate 6", "polyfly robust certificate 2"
PROGRAM = "box H f F A b S A_theta b_theta E C c".split()
MODEL = "A B G drift C tie_gain state_shift input_shift range input_range".split()
# Lines that state no number of the program.
PROOFS = set("""tolerances basis convexity coverage regions region inside follows facet drop leaf outside near
    beyond sliver dropped implied weights left_out dropped_follows tolerated tolerated_follows sliver_region
    sliver_cover half_space point simplex""".split())
# Lines that occur several times.
REPEATED = {"model", "state_range", "row"}

MOST_PREDICTIONS = 10000
# Each vertex of the disturbances is tried.
MOST_CHANNELS = 20
REAL = re.compile(r"-?0x[0-9a-f]+(\.[0-9a-f]+)?p[-+]?[0-9]{1,4}")
FRACTION = re.compile(r"(-?[0-9a-f]+)(?:/0*([1-9a-f][0-9a-f]*))?")
COUNT = re.compile(r"[0-9]{1,18}")

# y . (theta, u~_0, tau) + z . plan + sum of |term| <= bound. z maps places of the plan to factors; a term has a constant and
# such a map.
PlanRow = namedtuple("PlanRow", "bound y z terms")


def count_of(word):
    require(COUNT.fullmatch(word), f"{word} is no count")
    return int(word)


def fraction_of(word):
    found = FRACTION.fullmatch(word)
    require(found, f"{word} is no fraction")
    return Fraction(int(found[1], 16), int(found[2] or "1", 16))


def real_of(word):
    """A double as printf's %a writes it."""
    require(REAL.fullmatch(word), f"{word} is no finite number")
    return Fraction(float.fromhex(word))


def matrix_of(height, width, *words, read=real_of):
    height, width = count_of(height), count_of(width)
    require(len(words) == height * width, "a matrix has not the size that is stated")
    entries = list(map(read, words))
    return (height, width), [entries[at:at + width] for at in range(0, len(entries), width or 1)]


def counted(words, read):
    """A count, and so many items that `read` takes from an iterator over words."""
    return [read(words) for _ in range(count_of(next(words)))]


def whole_line(words, read):
    """What `read` makes of an iterator over words, all of which it takes."""
    words = iter(words)
    try:
        value = read(words)
    except StopIteration:
        raise Refused("a line is shorter than its rule") from None
    require(next(words, None) is None, "a line is longer than its rule")
    return value


def list_of_counts(words):
    return whole_line(words, lambda words: counted(words, lambda words: count_of(next(words))))


class Certificate:
    """Matrices of the program by name, and the rows that are equalities."""

    title = TITLE

    def __init__(self, content, region_map):
        self._lines = {}
        title, *lines = unsealed(content)
        require(title == self.title, f"the first line is not '{self.title}'")
        for key, *words in map(str.split, lines):
            if key not in PROOFS:
                require(key in REPEATED or key not in self._lines, f"{key} is given twice")
                self._lines.setdefault(key, []).append(words)
        problem = region_map.problem_bytes
        self._require_same("map", region_map.checksum, region_map.size)
        self._require_same("problem", xxh64(problem), len(problem))
        self.equalities = set(list_of_counts(self._take("equalities")))
        self._read(region_map)
        for key in self._lines:
            raise Refused(f"{key}: an unknown line")

    def _take(self, key):
        require(key in self._lines, f"{key} is missing")
        words, = self._lines.pop(key)
        return words

    def _require_same(self, key, checksum, size):
        require(self._take(key) == ["%016x" % checksum, str(size)], f"the certificate is of another {key}")

    def _read(self, region_map):
        read = {name: matrix_of(*self._take(name)) for name in PROGRAM}
        self.program = {name: matrix for name, (_, matrix) in read.items()}
        (n, _), (m, _), (k, _) = (read[name][0] for name in ("H", "A", "A_theta"))
        p, q = region_map.p, region_map.q
        sizes = ((p, 2), (n, n), (n, 1), (n, p), (m, n), (m, 1), (m, p), (k, p), (k, 1), (q, n), (q, p), (q, 1))
        require_sizes(read, dict(zip(PROGRAM, sizes)))
        require(self.program["box"] == region_map.box, "the box is not the map's")
        require(all(row < m for row in self.equalities), "equalities names no row")


def require_sizes(read, sizes):
    for name, (size, _) in read.items():
        require(size == sizes.get(name), f"{name}: its size does not fit")


class RobustCertificate(Certificate):
    """The model and the rows of a robust map's program."""

    title = ROBUST_TITLE

    def _read(self, region_map):
        p = region_map.p
        self._read_models(p)
        self.errors = list_of_counts(self._take("errors"))
        require(len(set(self.errors)) == len(self.errors) == self._nx > 0 and max(self.errors) < p,
                "errors: not one parameter for each state")
        self.state_ranges = {}
        for state, lower, upper in self._lines.pop("state_range", []):
            require(count_of(state) not in self.state_ranges, "a state has two ranges")
            self.state_ranges[count_of(state)] = fraction_of(lower), fraction_of(upper)
        self.predictions = count_of(*self._take("predictions"))
        require(self.predictions <= MOST_PREDICTIONS, "predictions is out of range")
        lines = self._lines.pop("row", [])
        self.rows = [whole_line(words, lambda words: self._row(words, p)) for words in lines]
        require(not self.equalities, "equalities of a robust program are not empty")

    def _read_models(self, p):
        read = {}
        for name, *words in self._lines.pop("model", []):
            require(name not in read, f"model {name} is given twice")
            read[name] = matrix_of(*words, read=fraction_of)
        require(set(MODEL) <= read.keys(), "model: a matrix is missing")
        self.models = {name: matrix for name, (_, matrix) in read.items()}
        (nx, _), (_, channels), (outputs, _) = (read[name][0] for name in ("A", "G", "C"))
        require(channels <= MOST_CHANNELS, "model G: has too many channels")
        self._nx = nx
        sizes = ((nx, nx), (nx, 1), (nx, channels), (nx, 1), (outputs, nx), (1, nx), (p, nx), (p, 1), (p, 2), (1, 2))
        require_sizes(read, {"feedback_gain": (1, nx), **dict(zip(MODEL, sizes))})

    def _row(self, words, p):
        bound, *y = [fraction_of(next(words)) for _ in range(p + 3)]
        z = self._sparse(words)
        terms = counted(words, lambda words: (fraction_of(next(words)), self._sparse(words)))
        return PlanRow(bound, y, z, terms)

    def _sparse(self, words):
        entries = counted(words, lambda words: (count_of(next(words)), fraction_of(next(words))))
        require(all(place < self.predictions for place, _ in entries), "a row names no prediction")
        require(len(dict(entries)) == len(entries), "a row names a prediction twice")
        return dict(entries)


def read_certificate(content, region_map):
    """The first line tells the kind."""
    is_robust = content.startswith(b"polyfly robust ")
    return (RobustCertificate if is_robust else Certificate)(content, region_map)
