"""Half-spaces in whole numbers: a . x <= bound is the list of a and bound. An exact dual simplex method finds multipliers of
rows; what counts is that they are checked."""
from fractions import Fraction

from exact import Refused, diagonal, dot, require, whole

# Half the width of a box in which maxima are sought. A maximum at its sides proves nothing.
BOX = 1 << 100
# With the most violated row; then with Bland's rule, which ends.
MOST_PIVOTS = 1000
MOST_BLAND_PIVOTS = 100000


def half_space(normal, bound):
    return whole([*normal, bound])


def side(size, entry, sign, bound):
    """sign x_entry <= bound"""
    return half_space([sign if j == entry else 0 for j in range(size)], bound)


def box_of(ranges, first, size):
    """The sides of ranges of the entries from `first` on."""
    sides = [((1, upper), (-1, -lower)) for lower, upper in ranges]
    return [side(size, j, *end) for j, ends in enumerate(sides, first) for end in ends]


class Vertex:
    """Rows that hold with equality, by their places. Row i has the product `determinant` > 0 with direction i, and 0 with the
    other directions. All numbers are whole."""

    def __init__(self, places, directions, determinant):
        self.places, self.directions, self.determinant = places, directions, determinant

    def products(self, function):
        """Of a function as the sum of the rows, the multipliers times the determinant."""
        return [dot(function, direction) for direction in self.directions]

    def exchanged(self, leaving, place, products):
        """With another row in place of one; `products` are those of the new row."""
        pivot, kept = products[leaving], self.directions[leaving]
        directions = [[(pivot * own - product * other) // self.determinant for own, other in zip(direction, kept)]
                      for direction, product in zip(self.directions, products)]
        directions[leaving] = kept
        places = self.places[:leaving] + [place] + self.places[leaving + 1:]
        return Vertex(places, directions, pivot)


class Polyhedron:
    """The set where all of some rows hold, at least one."""

    def __init__(self, rows):
        require(rows, "a set without half-spaces")
        self._size = len(rows[0]) - 1
        # Sides of the box have negative places, upper and lower ends by turns.
        box = box_of([(-BOX, BOX)] * self._size, 0, self._size)
        self._rows = {**dict(enumerate(rows)), **dict(enumerate(box, -len(box)))}
        self._widths = {place: max(map(abs, row[:-1])) or 1 for place, row in self._rows.items()}
        # Where maxima were found, the last one first.
        self._found = []

    def rows(self):
        return [row for place, row in self._rows.items() if place >= 0]

    def greatest(self, function):
        """An upper bound of function . x in the set: that of multipliers >= 0 whose sum of rows is the function. None where
        none are found."""
        *normal, unit = whole([*function, Fraction(1)])
        return next((bound / unit for bound in self._bounds(normal)), None)

    def is_within(self, row):
        """Whether the half-space holds in all of the set, by the same."""
        return any(bound <= row[-1] for bound in self._bounds(row[:-1]))

    def is_empty(self):
        """Whether no x meets all rows: multipliers >= 0 contradict."""
        vertex, entered = self._solve([0] * self._size)
        if entered is None:
            return False
        products = vertex.products(self._rows[entered][:-1])
        weights = [vertex.determinant, *(-product for product in products)]
        total = self._sum([entered, *vertex.places], weights)
        return total is not None and total[-1] < 0 and not any(total[:-1])

    def has_point(self):
        """Whether some x meets all rows: one that is found and substituted."""
        vertex, entered = self._solve([0] * self._size)
        return entered is None and all(dot(row, self._point(vertex)) <= 0 for row in self.rows())

    def drop_implied(self):
        """Leaves out rows that hold where the others do."""
        for place in range(len(self.rows()))[::-1]:
            row = self._rows.pop(place)
            if not self.is_within(row):
                self._rows[place] = row

    def _bounds(self, function):
        """Upper bounds of a function in whole numbers: by vertices at which others had their maxima, then by its own."""
        for k, vertex in enumerate(self._found):
            bound = self._bound(vertex, function)
            if bound is not None:
                self._found.insert(0, self._found.pop(k))
                yield bound
        vertex, entered = self._solve(function)
        bound = self._bound(vertex, function) if entered is None else None
        if bound is not None:
            self._found.insert(0, vertex)
            yield bound

    def _bound(self, vertex, function):
        weights = vertex.products(function)
        total = None if min(weights) < 0 else self._sum(vertex.places, weights)
        if total is None or total[:-1] != [vertex.determinant * entry for entry in function]:
            return None
        return Fraction(total[-1], vertex.determinant)

    def _sum(self, places, weights):
        """The sum of rows by weights, None where one is negative or of no row of the set."""
        total = [0] * (self._size + 1)
        for place, weight in zip(places, weights):
            if weight < 0 or (weight > 0 and (place < 0 or place not in self._rows)):
                return None
            if weight > 0:
                total = [entry + weight * own for entry, own in zip(total, self._rows[place])]
        return total

    def _solve(self, function):
        """The vertex of the maximum and None; or one, and the place of a row that contradicts those of the vertex."""
        # The vertex of the box at which the function is greatest.
        signs = [-1 if entry < 0 else 1 for entry in function]
        places = [2 * (j - self._size) + (sign < 0) for j, sign in enumerate(signs)]
        vertex = Vertex(places, diagonal(signs), 1)
        for pivots in range(MOST_PIVOTS + MOST_BLAND_PIVOTS):
            entered = self._entering(vertex, pivots >= MOST_PIVOTS)
            if entered is None:
                return vertex, None
            products = vertex.products(self._rows[entered][:-1])
            leaving = self._leaving(vertex, vertex.products(function), products)
            if leaving is None:
                return vertex, entered
            vertex = vertex.exchanged(leaving, entered, products)
        raise Refused("the simplex method does not end")

    def _point(self, vertex):
        """(x, -1) times the determinant."""
        bounds = [self._rows[place][-1] for place in vertex.places]
        return [dot(bounds, entries) for entries in zip(*vertex.directions)] + [-vertex.determinant]

    def _entering(self, vertex, takes_first):
        """The place of a row that the vertex violates, the most for its greatest entry; None where there is none."""
        point, worst, violation, width = self._point(vertex), None, 0, 1
        for place, row in self._rows.items():
            beyond = dot(row, point)
            if beyond > 0 and beyond * width > violation * self._widths[place]:
                worst, violation, width = place, beyond, self._widths[place]
                if takes_first:
                    break
        return worst

    @staticmethod
    def _leaving(vertex, weights, products):
        """Which row leaves, so that multipliers stay >= 0; None where none can."""
        ratios = [(Fraction(weight, product), vertex.places[j], j)
                  for j, (weight, product) in enumerate(zip(weights, products)) if product > 0]
        return min(ratios)[-1] if ratios else None


def without_entry(rows, place):
    """What the other entries of x must meet so that this one can be chosen: each upper bound of it with each lower one. The
    entry stays, with factor 0."""
    uppers, lowers = [row for row in rows if row[place] > 0], [row for row in rows if row[place] < 0]
    pairs = [whole([upper[place] * below - lower[place] * above for above, below in zip(upper, lower)])
             for upper in uppers for lower in lowers]
    return [row for row in rows if row[place] == 0] + pairs


def without_implied(rows):
    """The same set by fewer rows."""
    polyhedron = Polyhedron(rows)
    polyhedron.drop_implied()
    return polyhedron.rows()
