"""The program of a certificate, by the lines that state it (offline_mpt/CERTIFICATE.md). Its proofs are check_certificate's."""
import re
from fractions import Fraction

from exact import Matrix, Refused, require
from files import unsealed, xxh64

TITLE, ROBUST_TITLE = "polyfly certificate 6", "polyfly robust certificate 2"
HEAD = {"map", "problem", "tolerances", "equalities", "basis", "convexity", "coverage", "regions"}
PROGRAM = {"box", "H", "f", "F", "A", "b", "S", "A_theta", "b_theta", "E", "C", "c"}
PROOFS = {"region", "inside", "follows", "facet", "drop", "leaf", "outside", "near", "beyond", "sliver"}
# Of programs that are not strictly convex, or whose rows depend on each other.
FURTHER_PROOFS = {"dropped", "implied", "weights", "left_out", "dropped_follows", "tolerated", "tolerated_follows",
                  "sliver_region", "sliver_cover"}
ROBUST_PROOFS = {"left_out", "weights", "half_space", "point", "simplex"}

MOST_PREDICTIONS = 10000
# Each vertex of the disturbances is tried.
MOST_CHANNELS = 20
REAL = re.compile(r"-?0x[0-9a-f]+(\.[0-9a-f]+)?p[-+]?[0-9]{1,4}")
FRACTION = re.compile(r"(-?[0-9a-f]+)(?:/([0-9a-f]+))?")
COUNT = re.compile(r"[0-9]{1,18}")


class Line:
    """Words of one line, from the first to the last."""

    def __init__(self, text):
        self._words = text.split()
        self._at = 0

    def word(self):
        require(self._at < len(self._words), "a line is shorter than its rule")
        self._at += 1
        return self._words[self._at - 1]

    def rest(self, read):
        """What a function makes of each word that is left."""
        words, self._at = self._words[self._at:], len(self._words)
        return [read(word) for word in words]

    def count(self):
        return count_of(self.word())

    def fraction(self):
        return fraction_of(self.word())

    def end(self):
        require(self._at == len(self._words), "a line is longer than its rule")


def count_of(word):
    require(COUNT.fullmatch(word), f"{word} is no count")
    return int(word)


def fraction_of(word):
    found = FRACTION.fullmatch(word)
    require(found and (found[2] is None or int(found[2], 16) > 0), f"{word} is no fraction")
    return Fraction(int(found[1], 16), int(found[2] or "1", 16))


def real_of(word):
    """A double as printf's %a writes it."""
    require(REAL.fullmatch(word), f"{word} is no finite number")
    try:
        return Fraction(float.fromhex(word))
    except OverflowError:
        raise Refused(f"{word} is no finite number") from None


def matrix_of(line, name, read):
    rows, columns = line.count(), line.count()
    entries = line.rest(read)
    require(len(entries) == rows * columns, f"{name}: its size is not as stated")
    return Matrix([entries[i * columns:(i + 1) * columns] for i in range(rows)], columns)


class Certificate:
    """Matrices of the program by name, and the rows that are equalities."""

    title, proofs = TITLE, PROOFS | FURTHER_PROOFS

    def __init__(self, content, region_map):
        lines = unsealed(content).split("\n")
        require(lines[0] == self.title, f"the first line is not '{self.title}'")
        self._map = region_map
        self._head = set()
        self.program, self.equalities = {}, set()
        for text in lines[1:]:
            line = Line(text)
            key = line.word()
            if key not in self.proofs:
                self._read(key, line)
                line.end()
        for key in sorted(HEAD):
            require(key in self._head, f"{key} is missing")
        self._complete()

    def _read(self, key, line):
        if key in HEAD:
            require(key not in self._head, f"{key} is given twice")
            self._head.add(key)
            self._read_head(key, line)
        elif not self._read_program(key, line):
            raise Refused(f"{key}: an unknown line")

    def _read_head(self, key, line):
        if key in ("map", "problem"):
            of = self._map
            wanted = (of.checksum, of.size) if key == "map" else (xxh64(of.problem_bytes), len(of.problem_bytes))
            require((line.word(), line.count()) == ("%016x" % wanted[0], wanted[1]), f"the certificate is of another {key}")
        elif key == "equalities":
            rows = line.rest(count_of)
            require(rows and rows[0] == len(rows) - 1, "equalities: its size is not as stated")
            self.equalities = set(rows[1:])
        else:
            line.rest(str)

    def _read_program(self, key, line):
        if key in PROGRAM:
            require(key not in self.program, f"{key} is given twice")
            self.program[key] = matrix_of(line, key, real_of)
        return key in PROGRAM

    def _complete(self):
        for key in sorted(PROGRAM):
            require(key in self.program, f"{key} is missing")
        n, m = len(self.program["H"].rows), len(self.program["A"].rows)
        require_sizes(self.program, n, m, self._map.p, self._map.q)
        require(self.program["box"].rows == [[*map(Fraction, bounds)] for bounds in self._map.bounds[:self._map.p]],
                "the box is not the map's")
        require(all(row < m for row in self.equalities), "equalities names no row")


def require_sizes(program, n, m, p, q):
    k = len(program["A_theta"].rows)
    sizes = {"box": (p, 2), "H": (n, n), "f": (n, 1), "F": (n, p), "A": (m, n), "b": (m, 1), "S": (m, p),
             "A_theta": (k, p), "b_theta": (k, 1), "E": (q, n), "C": (q, p), "c": (q, 1)}
    for name, size in sizes.items():
        require(program[name].size == size, f"{name}: its size does not fit")


class PlanRow:
    """y . (theta, u~_0, tau) + z . plan + sum of |term| <= bound. z is a list of places and values; a term has a constant and
    such a list."""

    def __init__(self, bound, y, z, terms):
        self.bound, self.y, self.z, self.terms = bound, y, z, terms


class RobustCertificate(Certificate):
    """The model and the rows of a robust map's program."""

    title, proofs = ROBUST_TITLE, PROOFS | ROBUST_PROOFS

    def __init__(self, content, region_map):
        self.models, self.errors, self.state_ranges, self.rows = {}, [], {}, []
        self.predictions = None
        super().__init__(content, region_map)

    def _read_program(self, key, line):
        if key == "model":
            name = line.word()
            require(name not in self.models, f"{name} is given twice")
            self.models[name] = matrix_of(line, name, fraction_of)
        elif key == "errors":
            require(not self.errors, "errors is given twice")
            self.errors = [line.count() for _ in range(line.count())]
        elif key == "state_range":
            state = line.count()
            require(state not in self.state_ranges, "a state has two ranges")
            self.state_ranges[state] = line.fraction(), line.fraction()
        elif key == "predictions":
            require(self.predictions is None, "predictions is given twice")
            self.predictions = line.count()
            require(self.predictions <= MOST_PREDICTIONS, "predictions is out of range")
        elif key == "row":
            bound, *y = [line.fraction() for _ in range(self._map.p + 3)]
            z = self._sparse(line)
            self.rows.append(PlanRow(bound, y, z, [(line.fraction(), self._sparse(line)) for _ in range(line.count())]))
        else:
            return False
        return True

    def _sparse(self, line):
        require(self.predictions is not None, "predictions is missing")
        entries = [(line.count(), line.fraction()) for _ in range(line.count())]
        require(all(place < self.predictions for place, _ in entries), "a row names a prediction that is not there")
        return entries

    def _complete(self):
        """The sizes of the model fit."""
        require({"A", "G", "C"} <= self.models.keys() and self.predictions is not None, "model: is missing")
        nx, p, channels = len(self.models["A"].rows), self._map.p, self.models["G"].columns
        sizes = {"A": (nx, nx), "B": (nx, 1), "G": (nx, channels), "drift": (nx, 1),
                 "C": (len(self.models["C"].rows), nx), "tie_gain": (1, nx), "state_shift": (p, nx),
                 "input_shift": (p, 1), "range": (p, 2), "input_range": (1, 2)}
        for name in sizes:
            require(name in self.models, f"model {name}: is missing")
        for name, matrix in self.models.items():
            wanted = (1, nx) if name == "feedback_gain" else sizes.get(name)
            require(matrix.size == wanted, f"model {name}: its size does not fit")
        require(channels <= MOST_CHANNELS, "model G: has too many channels")
        require(all(state < nx for state in self.state_ranges), "state_range: no such state")
        require(0 < nx == len(self.errors) == len(set(self.errors)) and max(self.errors) < p,
                "errors: not one parameter for each state")
        require(not self.equalities, "equalities of a robust program are not empty")
        require(self._map.q in (1, 2), "a robust map has one input, and perhaps tau")


def read_certificate(content, region_map):
    """The first line tells the kind."""
    is_robust = content.startswith(b"polyfly robust ")
    return (RobustCertificate if is_robust else Certificate)(content, region_map)
