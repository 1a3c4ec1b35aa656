"""Writes `_polyfly.pyi`, the types of the module that C++ provides, out of the signatures in its help texts.

usage: make_stub.py FOLDER    the folder with the module; the stub goes beside it
"""
import importlib
import pathlib
import re
import sys

HEAD = '''"""Types of the module that C++ provides. Its help texts describe them."""
import os
from typing import Any, Dict, List, Optional, Union

from numpy.typing import ArrayLike, NDArray

__version__: str'''
# Members with these names are public too.
SHOWN = {"__bool__", "__call__", "__getitem__", "__len__", "_repr_svg_"}
ARRAY = re.compile(r"numpy\.ndarray(?:\[(?:[^\[\]]|\[[^\[\]]*\])*\])?")
SIGNATURE = re.compile(r"\w*\((.*)\) -> (.*)")


def is_public(name):
    return name in SHOWN or not name.startswith("_")


def signature(function):
    """Arguments and result of a function, as text of a stub."""
    arguments, result = SIGNATURE.fullmatch(function.__doc__.split("\n")[0]).groups()
    arguments = ARRAY.sub("ArrayLike", arguments).replace("os.PathLike", "Union[str, os.PathLike[str]]")
    return [re.sub(r"\b_polyfly\.", "", text).replace(": object", ": Any")
            for text in (arguments, ARRAY.sub("NDArray[Any]", result))]


def function_lines(name, function, is_member):
    arguments, result = signature(function)
    if is_member:
        arguments = re.sub(r"^\w+: \w+", "self", arguments)
    return f"def {name}({arguments}) -> {result}: ..."


def class_lines(kind):
    base = kind.__base__
    lines = [f"\n\nclass {kind.__name__}" + (f"({base.__name__})" if issubclass(kind, Exception) else "") + ":"]
    for name, member in vars(kind).items():
        if not is_public(name):
            continue
        if isinstance(member, property):
            lines += ["    @property", f"    def {name}(self) -> {signature(member.fget)[1]}: ..."]
        else:
            lines.append("    " + function_lines(name, member, is_member=True))
    return lines if len(lines) > 1 else [lines[0] + " ..."]


def main(folder):
    sys.path.insert(0, folder)
    sys.dont_write_bytecode = True
    module = importlib.import_module("_polyfly")
    lines = [HEAD]
    for name, value in sorted(vars(module).items()):
        if is_public(name):
            lines += class_lines(value) if isinstance(value, type) else ["\n\n" + function_lines(name, value, is_member=False)]
    pathlib.Path(folder, "_polyfly.pyi").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
