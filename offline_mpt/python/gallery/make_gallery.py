#!/usr/bin/env python3
"""Runs each script of the gallery and shows it with its picture and what it prints on one page.

usage: make_gallery.py FOLDER        # writes FOLDER/index.html and FOLDER/NAME.svg
"""
import ast
import html
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
SCRIPTS = ("double_integrator", "ball_on_plate", "rover_heading", "robust", "reduction", "certificate", "wind")
STYLE = """body { font: 15px/1.5 Helvetica, Arial, sans-serif; color: #1d2733; max-width: 1000px; margin: 2em auto; padding: 0 1em }
h1, h2 { font-weight: 600 } img { max-width: 100%; border: 1px solid #d5dbe1 }
pre { background: #f4f6f8; padding: 0.8em; overflow-x: auto; font-size: 13px } nav a { margin-right: 1em }"""


def section(name, folder):
    """Runs one script; its part of the page."""
    text = (HERE / f"{name}.py").read_text(encoding="utf-8")
    run = subprocess.run([sys.executable, "-B", HERE / f"{name}.py", folder / f"{name}.svg"], capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"{name}.py: {run.stderr.strip()}")
    about = ast.get_docstring(ast.parse(text))
    return (f'<h2 id="{name}">{name.replace("_", " ").capitalize()}</h2>\n<p>{html.escape(about)}</p>\n'
            f'<img src="{name}.svg" alt="{html.escape(about)}">\n<pre>{html.escape(run.stdout)}</pre>\n'
            f"<details><summary>{name}.py</summary><pre>{html.escape(text)}</pre></details>\n")


def main(folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    sections = [section(name, folder) for name in SCRIPTS]
    links = "".join(f'<a href="#{name}">{name.replace("_", " ")}</a>' for name in SCRIPTS)
    (folder / "index.html").write_text(
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>Polyfly in Python</title>\n'
        f"<style>{STYLE}</style></head><body>\n<h1>Polyfly in Python</h1>\n<nav>{links}</nav>\n" + "\n".join(sections) +
        "</body></html>\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
