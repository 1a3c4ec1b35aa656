"""Fields of problem files. A map is a dict, a list a list, and all else a Scalar. Numbers are doubles at their exact values."""
import re
from fractions import Fraction

import yaml

from exact import Matrix, Refused, require

LOADER = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
CONTROL = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f]")
# An optional sign, digits of which no zero leads, an optional point and exponent: readers of YAML disagree on all else.
DECIMAL = re.compile(r"[-+]?(?!0[0-9])([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
MOST_COUNT = 10**9


class Scalar(str):
    """A word or number as it is written, and whether it stands without quotes."""

    is_plain = True


class Fields(dict):
    def __missing__(self, key):
        raise Refused(f"problem: {key} is missing")


def document_of(text):
    """The document of a text. Refuses what not every reader of YAML takes as the same."""
    require(not CONTROL.search(text), "problem: has a control character")
    require(":]" not in text + "]", "problem: has ':' right before ']' or the end")
    try:
        return _converted(yaml.compose(text, Loader=LOADER), {})
    except (yaml.YAMLError, UnicodeError) as error:
        raise Refused(f"problem: {' '.join(str(error).split())}") from None
    except RecursionError:
        raise Refused("problem: is nested too deeply") from None


def _converted(node, known):
    """`known` are nodes that were converted: an alias may name one again."""
    require(node is not None, "problem: is empty")
    if id(node) not in known:
        if isinstance(node, yaml.MappingNode):
            known[id(node)] = _fields(node, known)
        elif isinstance(node, yaml.SequenceNode):
            known[id(node)] = [_converted(item, known) for item in node.value]
        else:
            known[id(node)] = Scalar(node.value)
            known[id(node)].is_plain = not node.style
    return known[id(node)]


def _fields(node, known):
    fields = Fields()
    for key, value in node.value:
        require(isinstance(key, yaml.ScalarNode), "problem: a key is no word")
        require(key.value not in fields, f"problem: {key.value} is given twice")
        fields[key.value] = _converted(value, known)
    return fields


def require_keys(node, known):
    """The node is a map of some of these keys."""
    require(isinstance(node, dict), "problem: an entry has no keys")
    for key in node:
        require(key in known.split(), f"problem: {key} is not known to this checker")


def require_head(root, kind, known):
    """The file is of this type and of version 1, with some of these keys."""
    require_keys(root, f"polyfly_problem name type description {known}")
    require(count_of(root["polyfly_problem"]) == 1, "problem: polyfly_problem: is another version")
    require(root["type"] == kind, f"problem: is of no type {kind}")


def items_of(node, key):
    """The entries of a list that may be missing."""
    items = node.get(key, [])
    require(isinstance(items, list), f"problem: {key} is no list")
    return items


def word_of(node):
    require(isinstance(node, Scalar), "problem: a word is missing")
    return node


def choice_of(node, key, words):
    """One of several words; the first where there is none."""
    word = word_of(node.get(key, Scalar(words[0])))
    require(word in words, f"problem: {word} is not known to this checker")
    return word


def decimal_of(text):
    require(DECIMAL.fullmatch(text), f"problem: {text} is no number in decimal digits without leading zeros")
    value = float(text)
    require(abs(value) != float("inf"), "problem: a number is not finite")
    return Fraction(value)


def number_of(node):
    require(isinstance(node, Scalar) and node.is_plain, "problem: a number is missing")
    return decimal_of(node)


def number_or(node, key, absent):
    return number_of(node[key]) if key in node else absent


def count_of(node):
    value = number_of(node)
    require(0 <= value <= MOST_COUNT and value.denominator == 1, f"problem: {node} is no whole number in range")
    return int(value)


def range_of(node, read=number_of):
    require(isinstance(node, list) and len(node) == 2, "problem: a range has two numbers")
    return read(node[0]), read(node[1])


def filled_range(node, read=number_of):
    lower, upper = range_of(node, read)
    require(lower < upper, "problem: a range is empty")
    return lower, upper


def matrix_of(node, height, columns, read=number_of):
    require(isinstance(node, list) and len(node) == height and
            all(isinstance(row, list) and len(row) == columns for row in node), "problem: a matrix has another size")
    return Matrix([[read(entry) for entry in row] for row in node], columns)


def weight_of(node, size, read=number_of):
    """A matrix, or its diagonal."""
    require(isinstance(node, list) and len(node) == size, "problem: a weight has another size")
    if isinstance(node[0], list):
        return matrix_of(node, size, size, read)
    diagonal = [read(entry) for entry in node]
    return Matrix([[entry if i == j else Fraction(0) for j in range(size)] for i, entry in enumerate(diagonal)], size)


def column_of(node, height):
    require(isinstance(node, list) and len(node) == height, "problem: a list has another size")
    return Matrix([[number_of(entry)] for entry in node], 1)
