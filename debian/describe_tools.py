#!/usr/bin/python3
"""Writes a man page of each command-line tool: what it and its subcommands print for --help.

usage: describe_tools.py FOLDER TOOL...     leaves FOLDER/TOOL.1
"""
import os
import re
import subprocess
import sys
import textwrap

WIDTH = 78


def help_of(command):
    return subprocess.run([*command, "--help"], stdout=subprocess.PIPE, check=True, universal_newlines=True).stdout


def is_prose(line):
    return not re.match(r"\s|[Uu]sage|.*:$|$", line)


def roff(text):
    """Text as it stands, with the lines of a paragraph joined, long ones broken, and hyphens that can be copied."""
    lines = []
    for line in text.strip("\n").split("\n"):
        if lines and is_prose(lines[-1]) and is_prose(line):
            lines[-1] += " " + line
        else:
            lines.append(line)
    laid_out = []
    for line in lines:
        beside = re.match(r"\s+\S.*?\s{2,}|\s+", line)
        laid_out += textwrap.wrap(line, WIDTH, subsequent_indent=" " * len(beside[0] if beside else ""),
                                  break_long_words=False, break_on_hyphens=False) or [""]
    escaped = "\n".join(laid_out).replace("\\", "\\e").replace("-", "\\-")
    return ".nf\n" + re.sub(r"^([.'])", r"\\&\1", escaped, flags=re.MULTILINE) + "\n.fi\n"


def summary(text):
    """The first sentence that is no usage."""
    sentence = re.split(r"[.:](?:\s|$)", " ".join(filter(is_prose, text.split("\n"))))[0]
    return sentence[0].lower() + sentence[1:].replace("-", "\\-")


def parts(command):
    """(command line, help) of a command and of all below it."""
    text = help_of(command)
    found = [(" ".join([os.path.basename(command[0]), *command[1:]]), text)]
    below = re.search(r"^Subcommands:\n((?:  .*\n)+)", text, flags=re.MULTILINE)
    for name in re.findall(r"^  ([a-z]\S*)", below[1], flags=re.MULTILINE) if below else []:
        found += parts([*command, name])
    return found


def page(tool):
    (name, text), *below = parts([tool])
    told = f'.TH {name.upper()} 1 "" "Polyfly" "User Commands"\n.SH NAME\n{name} \\- {summary(text)}\n.SH DESCRIPTION\n' + roff(text)
    return told + "".join(f".SH {command.upper()}\n" + roff(text) for command, text in below)


def main():
    folder, *tools = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    for tool in tools:
        with open(os.path.join(folder, os.path.basename(tool) + ".1"), "w", encoding="utf-8") as file:
            file.write(page(tool))


if __name__ == "__main__":
    main()
