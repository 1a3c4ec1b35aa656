"""Fields of problem files. A map is a dict, a list a list, and all else a Scalar."""
import re
from collections import Counter
from fractions import Fraction
from functools import lru_cache

import yaml

from exact import Refused, diagonal, require

LOADER = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
CONTROL = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f]")
# An optional sign, digits of which no zero leads, an optional point and exponent: readers disagree on all else.
DECIMAL = re.compile(r"[-+]?(?!0[0-9])([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?0*[0-9]{1,3})?")
MOST_COUNT = 10**9


class Scalar(str):
    """A word or number as it is written, and whether it stands without quotes."""

    is_plain = True


class Fields(dict):
    def __missing__(self, key):
        raise Refused(f"problem: {key} is missing")


@lru_cache(maxsize=2)
def document_of(text):
    """The map of a text. Refuses what not every reader of YAML takes as the same."""
    require(not CONTROL.search(text), "problem: has a control character")
    require(":]" not in text + "]", "problem: has ':' right before ']' or the end")
    try:
        root = _converted(yaml.compose(text, Loader=LOADER))
    except (yaml.YAMLError, UnicodeError, RecursionError) as error:
        raise Refused(f"problem: {' '.join(str(error).split())}") from None
    require(isinstance(root, dict), "problem: an entry has no keys")
    return root


@lru_cache(maxsize=None)
def _converted(node):
    if isinstance(node, yaml.SequenceNode):
        return [_converted(item) for item in node.value]
    if isinstance(node, yaml.MappingNode):
        for key, count in Counter(key.value for key, _ in node.value).items():
            require(count == 1, f"problem: {key} is given twice")
        return Fields((key.value, _converted(value)) for key, value in node.value)
    require(node is not None, "problem: is empty")
    scalar = Scalar(node.value)
    scalar.is_plain = not node.style
    return scalar


def require_keys(node, known):
    """The node is a map of some of these keys."""
    require(isinstance(node, dict), "problem: an entry has no keys")
    for key in node:
        require(key in known.split(), f"problem: {key} is not known to this checker")


def require_head(root, kind, known):
    """The file is of this type and of version 1, with some of these keys."""
    require_keys(root, "polyfly_problem name type description " + known)
    require(count_of(root["polyfly_problem"]) == 1, "problem: polyfly_problem: is another version")
    require(root["type"] == kind, f"problem: is of no type {kind}")


def items_of(node, key, known):
    """The entries of a list, which may be missing; each is a map of some of these keys."""
    items = node.get(key, [])
    require(isinstance(items, list), f"problem: {key} is no list")
    for item in items:
        require_keys(item, known)
    return items


def choice_of(node, key, *words):
    """One of several words; the first where there is none."""
    word = node.get(key, words[0])
    require(word in words, f"problem: {word} is not known to this checker")
    return word


def decimal_of(text, kind):
    require(DECIMAL.fullmatch(text), f"problem: {text} is no number in decimal digits without leading zeros")
    value = kind(text)
    require(value != float("inf") and value != -float("inf"), "problem: a number is not finite")
    return Fraction(value)


def exact_of(node):
    """A number as written, or a quotient of two."""
    require(isinstance(node, Scalar), "problem: a number is missing")
    above, slash, below = node.partition("/")
    divisor = decimal_of(below, Fraction) if slash else 1
    require(divisor != 0, "problem: a division by 0")
    return decimal_of(above, Fraction) / divisor


def number_of(node):
    """A double at its exact value."""
    require(isinstance(node, Scalar) and node.is_plain, "problem: a number is missing")
    return decimal_of(node, float)


def number_or(node, key, absent):
    return number_of(node[key]) if key in node else absent


def count_of(node):
    value = number_of(node)
    require(0 <= value <= MOST_COUNT and value.denominator == 1, f"problem: {node} is no count in range")
    return int(value)


def list_of(node, count, read=number_of):
    require(isinstance(node, list) and len(node) == count, f"problem: a list has not {count} entries")
    return [read(entry) for entry in node]


def range_of(node, read=number_of):
    lower, upper = list_of(node, 2, read)
    require(lower < upper, "problem: a range is empty")
    return lower, upper


def matrix_of(node, height, width, read=number_of):
    return list_of(node, height, lambda row: list_of(row, width, read))


def weight_of(node, size, read=number_of):
    """A matrix, or its diagonal."""
    is_matrix = isinstance(node, list) and node and isinstance(node[0], list)
    return matrix_of(node, size, size, read) if is_matrix else diagonal(list_of(node, size, read))
