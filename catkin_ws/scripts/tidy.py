#!/usr/bin/env python3
"""Runs clang-tidy over the C++ files of a configured build, or over those below the folders that are given.

usage: tidy.py BUILD NOTES [PATH...]

A file that was found clean is noted in the folder NOTES by its content, with that of the project's headers that it
includes, of .clang-tidy and of its compiler options, and is not looked at again until one of them changes. So a run that
was interrupted goes on where it was. Ends with status 1 where something was found.
"""
import concurrent.futures
import functools
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*["<]([^">]+)[">]', re.MULTILINE)


@functools.lru_cache(maxsize=None)
def content(path):
    with open(path, "rb") as file:
        return file.read()


def below(path, folder):
    return path == folder or path.startswith(folder + os.sep)


def closure(source, folders):
    """The source and all files of the project that it includes, in folders or beside themselves."""
    found, waiting = {source}, [source]
    while waiting:
        path = waiting.pop()
        for name in INCLUDE.findall(content(path)):
            for folder in (os.path.dirname(path), *folders):
                candidate = os.path.normpath(os.path.join(folder, name.decode()))
                if os.path.isfile(candidate):
                    if below(candidate, ROOT) and candidate not in found:
                        found.add(candidate)
                        waiting.append(candidate)
                    break
    return sorted(found)


def key(entry, version):
    """Changes with everything that clang-tidy's answer depends on, but for the system's headers."""
    folders = [word[2:] for word in shlex.split(entry["command"]) if word.startswith("-I")]
    digest = hashlib.sha256()
    for part in (version, content(os.path.join(ROOT, ".clang-tidy")), entry["command"].replace(ROOT, "").encode()):
        digest.update(hashlib.sha256(part).digest())
    for path in closure(entry["file"], folders):
        digest.update(os.path.relpath(path, ROOT).encode() + b"\0" + hashlib.sha256(content(path)).digest())
    return digest.hexdigest()


def entries(build, paths):
    """One compile command for each file, with assertions seen; the file that was edited last comes first."""
    with open(os.path.join(build, "compile_commands.json")) as file:
        commands = json.load(file)
    chosen = {}
    for entry in commands:
        if any(below(entry["file"], path) for path in paths):
            chosen.setdefault(entry["file"], dict(entry, command=entry["command"].replace(" -DNDEBUG", "")))
    return sorted(chosen.values(), key=lambda entry: -os.stat(entry["file"]).st_mtime)


def look(notes, file):
    return subprocess.run(["clang-tidy", "-p", notes, "--quiet", file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True)


def main(build, notes, paths):
    os.makedirs(notes, exist_ok=True)
    todo = entries(build, [os.path.abspath(path) for path in paths] or [ROOT])
    with open(os.path.join(notes, "compile_commands.json"), "w") as file:
        json.dump(todo, file, indent=1)
    version = subprocess.run(["clang-tidy", "--version"], stdout=subprocess.PIPE, check=True).stdout
    noted = {entry["file"]: os.path.join(notes, key(entry, version)) for entry in todo}
    files = [file for file, note in noted.items() if not os.path.exists(note)]
    print("%d of %d files are as they were when they were found clean" % (len(noted) - len(files), len(noted)), flush=True)
    bad = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        running = {pool.submit(look, notes, file): file for file in files}
        for done, future in enumerate(concurrent.futures.as_completed(running), 1):
            file, answer = running[future], future.result()
            if answer.returncode == 0:
                with open(noted[file], "w"):
                    pass
            else:
                bad.append(file)
                print(answer.stdout, flush=True)
            print("[%d/%d] %s" % (done, len(files), os.path.relpath(file, ROOT)), flush=True)
    for file in sorted(bad):
        print("found something in", os.path.relpath(file, ROOT))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]))
