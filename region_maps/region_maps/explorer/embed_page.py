#!/usr/bin/env python3
"""Joins the explorer's HTML, CSS and JavaScript into one page and writes it as a C++ source.

usage: embed_page.py OUTPUT.cpp PAGE.html STYLE.css SCRIPT.js...

The scripts become one, in the order given. The page's policy allows this script and this style by their hashes only.
"""
import base64
import hashlib
import pathlib
import sys

DELIMITER = "PAGE"
# A compiler must take literals of 65,536 characters, and need not take longer ones.
LITERAL_BYTES = 60000


def source_hash(text):
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def literals(text):
    """The text as raw strings, cut at ends of lines."""
    pieces = [""]
    for line in text.splitlines(keepends=True):
        if len((pieces[-1] + line).encode()) > LITERAL_BYTES:
            pieces.append("")
        pieces[-1] += line
    return ",\n".join(f'R"{DELIMITER}({piece}){DELIMITER}"' for piece in pieces)


def main(output, page, style, *scripts):
    css = pathlib.Path(style).read_text(encoding="utf-8")
    script = "(() => {\n'use strict';\n" + "".join(pathlib.Path(path).read_text(encoding="utf-8") for path in scripts) + "})();\n"
    text = pathlib.Path(page).read_text(encoding="utf-8")
    for mark, value in (("@SCRIPT_HASH@", source_hash(script)), ("@STYLE_HASH@", source_hash(css)), ("@STYLE@", css),
                        ("@SCRIPT@", script)):
        if text.count(mark) != 1:
            sys.exit(f"{page}: must hold {mark} once")
        text = text.replace(mark, value)
    if f"){DELIMITER}\"" in text:
        sys.exit(f"{page}: must not hold the delimiter of a raw string")
    pathlib.Path(output).write_text(
        '#include "page_template.hpp"\n\nnamespace polyfly {\n\n'
        f"const std::initializer_list<std::string_view> kPageTemplate = {{\n{literals(text)}}};\n\n}}  // namespace polyfly\n",
        encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
