"""Programs out of arrays. What they become is the text of a problem file, which the map carries."""
from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from ._polyfly import Program, parse_program

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike


def _numbers(value, columns=False):
    """Nested lists, with None for what is not finite, which the reader refuses. With `columns`, a list is one column."""
    array = np.asarray(value, dtype=float)
    array = np.ravel(array) if not columns else array if array.ndim == 2 else array[:, None]
    return np.where(np.isfinite(array), array, None).tolist()


def MPQP(H: ArrayLike, f: ArrayLike, F: ArrayLike, A: ArrayLike, b: ArrayLike, B: ArrayLike, lo: ArrayLike, hi: ArrayLike, *,
         out: Sequence[int] | None = None, equalities: Sequence[int] = (), A_theta: ArrayLike | None = None,
         b_theta: ArrayLike | None = None, name: str = "mpqp") -> Program:
    """The Program min_z 1/2 z'Hz + (f + F theta)'z s.t. A z <= b + B theta, lo <= theta <= hi.

    Rows in `equalities` (from 0) hold with '=', and A_theta theta <= b_theta. out: entries of z that are the result; all by
    default.
    """
    entries = {"name": name, "H": _numbers(H, True), "f": _numbers(f), "F": _numbers(F, True), "A": _numbers(A, True),
               "b": _numbers(b), "B": _numbers(B, True), "lb": _numbers(lo), "ub": _numbers(hi)}
    if out is not None:
        entries["out"] = [int(index) for index in out]
    if len(equalities) > 0:
        entries["eq_ids"] = [int(row) for row in equalities]
    if A_theta is not None:
        entries["A_theta"] = _numbers(A_theta, True)
    if b_theta is not None:
        entries["b_theta"] = _numbers(b_theta)
    return parse_program(json.dumps(entries), name)


def MPLP(f: ArrayLike, F: ArrayLike, A: ArrayLike, b: ArrayLike, B: ArrayLike, lo: ArrayLike, hi: ArrayLike, *,
         name: str = "mplp", **options) -> Program:
    """As MPQP with H = 0: a linear program."""
    return MPQP(np.zeros((len(f), len(f))), f, F, A, b, B, lo, hi, name=name, **options)
