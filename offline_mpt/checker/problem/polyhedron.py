"""Half-spaces in whole numbers: a . x <= bound is the list of a and bound. An exact dual simplex method finds multipliers of
rows; what counts is that they are checked."""
from fractions import Fraction

from exact import Refused, dot, require, whole

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


class Vertex:
    """Rows that hold with equality, by their places. Row i has the product `determinant` > 0 with direction i, and 0 with the
    other directions. All numbers are whole."""

    def __init__(self, places, directions, determinant):
        self.places, self.directions, self.determinant = places, directions, determinant

    def weights(self, function):
        """Multipliers of the rows, times the determinant."""
        return [dot(function, direction) for direction in self.directions]

    def exchanged(self, leaving, place, products):
        """With another row in place of one; `products` are those of the new row and the directions."""
        pivot, kept = products[leaving], self.directions[leaving]
        directions = [kept if j == leaving else [(pivot * entry - products[j] * other) // self.determinant
                                                 for entry, other in zip(direction, kept)]
                      for j, direction in enumerate(self.directions)]
        places = [place if j == leaving else own for j, own in enumerate(self.places)]
        return Vertex(places, directions, pivot)


class Polyhedron:
    """The set where all of some rows hold, at least one."""

    def __init__(self, rows):
        require(rows, "a set without half-spaces")
        self._size = len(rows[0]) - 1
        self._rows = dict(enumerate(rows))
        # Sides of the box have negative places.
        for entry in range(self._size):
            self._rows[-1 - 2 * entry] = side(self._size, entry, 1, BOX)
            self._rows[-2 - 2 * entry] = side(self._size, entry, -1, BOX)
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
        vertex, entered = self._solve(self._rows[-1][:-1])
        if entered is None:
            return False
        products = vertex.weights(self._rows[entered][:-1])
        weights = [vertex.determinant, *(-product for product in products)]
        summed = self._sum([entered, *vertex.places], weights)
        return summed is not None and summed[-1] < 0 and not any(summed[:-1])

    def has_point(self):
        """Whether some x meets all rows: one that is found and substituted."""
        vertex, entered = self._solve(self._rows[-1][:-1])
        return entered is None and all(dot(row, self._point(vertex)) <= 0 for row in self.rows())

    def drop_implied(self):
        """Leaves out rows that hold where the others do."""
        for place in sorted((place for place in self._rows if place >= 0), reverse=True):
            row = self._rows.pop(place)
            if not self.is_within(row):
                self._rows[place] = row

    def _bounds(self, function):
        """Upper bounds of a function in whole numbers, by vertices at which others had their maxima, and by its own."""
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
        weights = vertex.weights(function)
        summed = None if min(weights) < 0 else self._sum(vertex.places, weights)
        if summed is None or summed[:-1] != [vertex.determinant * entry for entry in function]:
            return None
        return Fraction(summed[-1], vertex.determinant)

    def _sum(self, places, weights):
        """The sum of rows by weights >= 0, None where one is negative or of no row."""
        used = [(weight, self._rows.get(place)) for place, weight in zip(places, weights) if weight]
        if any(weight < 0 or row is None for weight, row in used) or any(
                place < 0 and weight for place, weight in zip(places, weights)):
            return None
        return [sum(weight * row[j] for weight, row in used) for j in range(self._size + 1)]

    def _solve(self, function):
        """The vertex of the maximum and None; or one, and the place of a row that contradicts those of the vertex."""
        for takes_first, most in ((False, MOST_PIVOTS), (True, MOST_BLAND_PIVOTS)):
            vertex = self._start(function)
            for _ in range(most):
                entered = self._entering(vertex, takes_first)
                if entered is None:
                    return vertex, None
                products = vertex.weights(self._rows[entered][:-1])
                leaving = self._leaving(vertex, vertex.weights(function), products)
                if leaving is None:
                    return vertex, entered
                vertex = vertex.exchanged(leaving, entered, products)
        raise Refused("the simplex method does not end")

    def _start(self, function):
        """The vertex of the box at which the function is greatest."""
        signs = [-1 if entry < 0 else 1 for entry in function]
        places = [-1 - 2 * j if sign > 0 else -2 - 2 * j for j, sign in enumerate(signs)]
        directions = [[sign if i == j else 0 for i in range(self._size)] for j, sign in enumerate(signs)]
        return Vertex(places, directions, 1)

    def _point(self, vertex):
        """(x, -1) times the determinant."""
        bounds = [self._rows[place][-1] for place in vertex.places]
        return [dot(bounds, entries) for entries in zip(*vertex.directions)] + [-vertex.determinant]

    def _entering(self, vertex, takes_first):
        """The place of a row that the vertex violates, the most for its greatest entry; None where there is none."""
        point = self._point(vertex)
        worst, violation, width = None, 0, 1
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
        leaving = None
        for j, (weight, product) in enumerate(zip(weights, products)):
            if product <= 0:
                continue
            if leaving is not None:
                order = weight * products[leaving] - weights[leaving] * product
                if order > 0 or (order == 0 and vertex.places[j] > vertex.places[leaving]):
                    continue
            leaving = j
        return leaving


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
