"""What the builders of problems share: numbers and signals as text of a problem file, and what is done with it."""
from __future__ import annotations

import numbers
from typing import TYPE_CHECKING

import numpy as np

from ._polyfly import Error, Map, OnlineProgram, OnlineRobust

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence
    from fractions import Fraction
    from typing import Any, Optional, TypeVar, Union

    from numpy.typing import ArrayLike

    Names = Optional[Sequence[Union[str, tuple[str, str]]]]
    Range = tuple[ArrayLike, ArrayLike]
    Softness = Optional[Union[float, Mapping[str, Union[float, str]]]]
    Exact = Union[float, str, Fraction]
    Ranges = Mapping[str, Any]
    Self = TypeVar("Self", bound="Statement")


def number(value):
    """Every bit of a number; a fraction or a text stays as it is."""
    return str(value) if is_exact(value) else repr(float(value))


def is_exact(value):
    """Whether it is a fraction, or the text of a number."""
    is_fraction = isinstance(value, numbers.Rational) and not isinstance(value, numbers.Integral)
    return isinstance(value, str) or is_fraction


def row(values):
    return "[" + ", ".join(number(value) for value in values) + "]"


def rows(value):
    return "[" + ", ".join(row(entries) for entries in value) + "]"


def matrix(value):
    """Rows of numbers. A single row may be a list."""
    return np.atleast_2d(np.asarray(value, dtype=object))


def column(value):
    """A matrix; a list is one column."""
    value = np.asarray(value, dtype=object)
    return value.reshape(-1, 1) if value.ndim == 1 else matrix(value)


def weight(value):
    """The diagonal, or a symmetric matrix as rows."""
    value = np.atleast_1d(np.asarray(value, dtype=float))
    return row(value) if value.ndim == 1 else rows(value)


def ranges(name, bounds, count):
    """`count` pairs (lower, upper) out of a pair of numbers or lists, or a list of such pairs; infinite where there is none."""
    if bounds is None:
        return [(-np.inf, np.inf)] * count
    if isinstance(bounds, list) and len(bounds) == count and all(isinstance(pair, tuple) and len(pair) == 2 for pair in bounds):
        return bounds
    if count == 2 and not isinstance(bounds, tuple) and np.ndim(bounds) == 2:
        raise Error(f"bounds: {name} can be read as (lower, upper) of lists, and as a list of pairs: "
                    "write a tuple of two lists, or a list of tuples")
    try:
        lower, upper = (np.broadcast_to(np.asarray(side, dtype=object), count) for side in bounds)
    except (TypeError, ValueError) as error:
        raise Error(f"bounds: {name} must be a pair (lower, upper) of numbers, or of lists of {count}, or a list of {count} pairs") from error
    return list(zip(lower, upper))


def signals(named, prefix, count):
    """Pairs (name, unit) out of names or such pairs."""
    if named is None:
        named = [prefix] if count == 1 else [f"{prefix}_{index}" for index in range(count)]
    pairs = [(entry, "1") if isinstance(entry, str) else tuple(entry) for entry in named]
    if len(pairs) != count:
        raise Error(f"{prefix}: must name {count}, got {len(pairs)}")
    return pairs


def state_signals(named, parameters, count):
    """Pairs (name, unit) of states. Those that are not named are called as their error parameters `e_STATE` say."""
    errors = [name[2:] for name in parameters if name.startswith("e_")]
    return signals(errors if named is None and len(errors) == count else named, "x", count)


def signal_lines(title, pairs, bounds):
    """The list of signals of a model; those without a finite bound have no range."""
    lines = [f"  {title}:"]
    for (name, unit), ends in zip(pairs, bounds):
        bounded = any(is_exact(end) or not np.isinf(end) for end in ends)
        range_text = f", range: {row(ends)}" if bounded else ""
        lines.append(f"    - {{name: {name}, unit: '{unit}'{range_text}}}")
    return lines


def head(name, kind, description):
    """The first lines of a problem file."""
    lines = ["polyfly_problem: 1", f"name: {name}", f"type: {kind}"]
    return lines + ["description: '" + description.replace("'", "''") + "'"] if description else lines


class Statement:
    """A problem under construction. Subclasses give `text` and `problem`."""

    _parameters = None

    def parameters(self: Self, ranges_by_name: Ranges) -> Self:
        """The box of the law: {name: (lower, upper)}, in the order of theta."""
        self._parameters = dict(ranges_by_name)
        return self

    def explicit(self, parameters: Ranges | None = None, **options: Any) -> Map:
        """The Map of the problem; options are those of Problem.solve."""
        if parameters is not None:
            self.parameters(parameters)
        return self.problem().solve(**options)

    def online(self, parameters: Ranges | None = None) -> OnlineProgram | OnlineRobust:
        """The problem for solutions at single parameters."""
        if parameters is not None:
            self.parameters(parameters)
        return self.problem().online()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the problem file, for `offline_mpt solve`."""
        self.problem().save(path)
