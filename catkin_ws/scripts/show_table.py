#!/usr/bin/env python3
"""Prints the rows of a build/bench/NAME.json as a table, and refuses rows that break the form.

usage: show_table.py FILE

The file is a list of rows {"name", "value", "unit"}, with "peer" and "peer_value" where a peer is known.
"""
import json
import numbers
import sys


def check(row, path):
    for key in ("name", "unit"):
        if not isinstance(row.get(key), str) or (key == "name" and not row[key]):
            sys.exit(f"{path}: row {row}: '{key}' must be a text")
    if not isinstance(row.get("value"), numbers.Real):
        sys.exit(f"{path}: row {row}: 'value' must be a number")
    if ("peer" in row) != ("peer_value" in row):
        sys.exit(f"{path}: row {row}: 'peer' and 'peer_value' come together")


def main(path):
    with open(path) as file:
        rows = json.load(file)
    if not isinstance(rows, list) or not rows:
        sys.exit(f"{path}: must be a list of rows, with at least one")
    for row in rows:
        check(row, path)
    width = max(len(row["name"]) for row in rows)
    for row in rows:
        peer = f"   {row['peer']}: {row['peer_value']:.6g}" if "peer" in row else ""
        print(f"  {row['name']:{width}}  {row['value']:>12.6g} {row['unit']}{peer}")
    print(f"  rows: {path}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
