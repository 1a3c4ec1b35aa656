#!/usr/bin/env python3
"""Prints what a configure preset of CMakePresets.json tells CMake, one argument a line, for a CMake that reads no presets.

usage: preset.py NAME
"""
import json
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def resolved(presets, name):
    """The preset with what it inherits."""
    own = presets[name]
    parent = resolved(presets, own["inherits"]) if "inherits" in own else {"cacheVariables": {}}
    return {**parent, **own, "cacheVariables": {**parent["cacheVariables"], **own.get("cacheVariables", {})}}


def arguments(name):
    with open(os.path.join(ROOT, "CMakePresets.json")) as file:
        preset = resolved({found["name"]: found for found in json.load(file)["configurePresets"]}, name)

    def expanded(text):
        text = text.replace("${sourceDir}", ROOT).replace("${presetName}", name)
        return re.sub(r"\$env\{(\w+)\}", lambda match: os.environ.get(match[1], ""), text)

    yield from ("-S", ROOT, "-B", expanded(preset["binaryDir"]), "-G", preset["generator"])
    for variable, value in preset["cacheVariables"].items():
        yield f"-D{variable}={expanded(value)}"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print(*arguments(sys.argv[1]), sep="\n")
