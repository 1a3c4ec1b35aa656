"""Programs out of MATLAB's files."""
from __future__ import annotations

import os
import pathlib

import numpy as np

from ._polyfly import Error, Program
from .program import MPLP, MPQP

REQUIRED = ("f", "F", "A", "b", "B", "lo", "hi")
VECTORS = ("f", "b", "lo", "hi", "b_theta")


def load_mat(path: str | os.PathLike[str]) -> Program:
    """The Program of a .mat file whose variables are named as the arguments of MPQP. Without H it is an MPLP.

    `A_theta`, `b_theta`, `out` and `equalities` may be there; the last two count from 1, as MATLAB does. Other variables
    are left alone. Needs scipy (Debian: python3-scipy), and a file of version 7 or older.
    """
    try:
        from scipy.io import loadmat
    except ImportError as error:
        raise Error(f"{path}: cannot be read without scipy") from error
    try:
        found = {name: value for name, value in loadmat(path).items() if not name.startswith("__")}
    except FileNotFoundError as error:
        raise Error(f"{path}: cannot be opened: no such file") from error
    except (NotImplementedError, ValueError, TypeError) as error:
        raise Error(f"{path}: must be a .mat file of version 7 or older") from error
    missing = [name for name in REQUIRED if name not in found]
    if missing:
        raise Error(f"{path}: {missing[0]}: missing")
    arrays = {name: np.ravel(found[name]) if name in VECTORS else found[name]
              for name in ("H", *REQUIRED, "A_theta", "b_theta") if name in found}
    indices = {name: [int(index) - 1 for index in np.ravel(found[name])]
               for name in ("out", "equalities") if name in found}
    return (MPQP if "H" in found else MPLP)(**arrays, **indices, name=pathlib.Path(path).stem)
