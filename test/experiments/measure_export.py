"""Measures exported code of a map on an emulated Cortex-M4F: bytes of code and stack, and instructions.

usage: measure_export.py FOLDER

FOLDER is that of `offline_mpt export`. The inputs are the vectors of NAME_test.c, of which the first have the most
operations. The result is added to NAME.json as "cortex_m4f". Needs arm-none-eabi-gcc and qemu-system-arm.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from collections import namedtuple

HERE = os.path.dirname(os.path.abspath(__file__))
FLAGS = ["-std=c99", "-O2", "-ffp-contract=off"]
TARGET = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]
BILLION = 1e9
# Prefix of the code, type, call of its answer with theta and u, and whether that needs a workspace.
Code = namedtuple("Code", "name real call has_workspace")
Measured = namedtuple("Measured", "flash ram stack answers")


def run(command, folder=None):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("%s failed:\n%s%s" % (command[0], done.stdout, done.stderr))
    return done


def write_inputs(place, real, thetas, input_count):
    numbers = ",\n".join("{%s}" % ", ".join("(REAL)%r" % value for value in theta) for theta in thetas)
    with open(os.path.join(place, "embedded_inputs.h"), "w") as file:
        file.write("#define REAL %s\n#define PARAMETER_COUNT %d\n#define INPUT_COUNT %du\n#define ANSWER_COUNT %d\n#define ANSWER(u) (int32_t)((u) * (REAL)1e9)\n"
                   "static const REAL inputs[INPUT_COUNT][PARAMETER_COUNT] = {%s};\n"
                   % (real, len(thetas[0]), len(thetas), input_count, numbers))
    for file in ("embedded_count.c", "embedded_memory.ld"):
        shutil.copy(os.path.join(HERE, file), place)


def emulate(place, sources):
    """Rows (status, instructions, first input) of the inputs in embedded_inputs.h."""
    run(["arm-none-eabi-gcc", *FLAGS, *TARGET, "-nostartfiles", "-T", "embedded_memory.ld", "embedded_count.c", *sources, "-lm", "-o", "count.elf"],
        place)
    told = run(["qemu-system-arm", "-M", "mps2-an386", "-nographic", "-icount", "shift=10", "-semihosting-config", "enable=on,target=native",
                "-kernel", "count.elf"], place)
    answers = []
    for line in (told.stdout + told.stderr).splitlines():
        status, instructions, u = (int(word, 16) for word in line.split())
        answers.append((status, instructions, (u - (1 << 32) if u >> 31 else u) / BILLION))
    return answers


def sizes(place, file):
    """Bytes of code and constants, and of writable data, of an object or of all in a library."""
    rows = [line.split() for line in run(["arm-none-eabi-size", file], place).stdout.splitlines()[1:]]
    return sum(int(row[0]) + int(row[1]) for row in rows), sum(int(row[1]) + int(row[2]) for row in rows)


def count(place, code, thetas, input_count=1):
    """What the code in a folder takes. The stack is the sum of all its functions, without the compiler's own routines."""
    write_inputs(place, code.real, thetas, input_count)
    real = code.real
    with open(os.path.join(place, "answer.c"), "w") as file:
        file.write('#include "%s.h"\n%s\nint embeddedAnswer(const %s theta[%d], %s u[%d]);\nint embeddedAnswer(const %s theta[%d], %s u[%d]) '
                   "{ return (int)%s; }\n"
                   % (code.name, "static %s_workspace workspace;" % code.name if code.has_workspace else "", real, len(thetas[0]), real,
                      input_count, real, len(thetas[0]), real, input_count, code.call))
    source, object_file = code.name + ".c", code.name + ".o"
    run(["arm-none-eabi-gcc", *FLAGS, *TARGET, "-fstack-usage", "-c", source, "-o", object_file], place)
    with open(os.path.join(place, code.name + ".su")) as file:
        stack = sum(int(line.split("\t")[1]) for line in file)
    with open(os.path.join(place, code.name + ".json")) as file:
        ram = json.load(file).get("workspace_bytes", 0)
    return Measured(sizes(place, object_file)[0], ram, stack, emulate(place, ["answer.c", source]))


def count_library(place, library, real, thetas):
    """(bytes of flash, of RAM, rows as of emulate) of a peer's object or library that defines embeddedAnswer."""
    write_inputs(place, real, thetas, 1)
    answers = emulate(place, [library])
    return (*sizes(place, library), answers)


def vectors(place, name, facts):
    """The parameters of NAME_test.c, as the map's numbers."""
    with open(os.path.join(place, name + "_test.c")) as file:
        text = file.read()
    first = text.index("_theta[") if "_theta[" in text else text.index(" theta[")
    numbers = [float(word.rstrip("f")) for word in re.findall(r"-?\d[\d.e+-]*f?", text[text.index("{", first):text.index(";", first)])]
    size = facts["parameters"]
    return [numbers[i:i + size] for i in range(0, len(numbers), size)]


def main(place):
    names = [name for name in os.listdir(place) if name.endswith(".json")]
    if len(names) != 1:
        sys.exit("%s: must have one file *.json" % place)
    path = os.path.join(place, names[0])
    with open(path) as file:
        facts = json.load(file)
    if "worst_case" not in facts or "regions" not in facts:
        sys.exit("%s: is not of a map's code" % path)
    name = facts["name"]
    measured = count(place, Code(name, facts["type"], name + "_evaluate(theta, u)", False), vectors(place, name, facts), facts["inputs"])
    compiler = run(["arm-none-eabi-gcc", "-dumpversion"]).stdout.strip()
    facts["cortex_m4f"] = {"compiler": "arm-none-eabi-gcc %s %s" % (compiler, " ".join(FLAGS)), "flash_bytes": measured.flash,
                           "code_bytes": measured.flash - facts["table_bytes"], "stack_bytes": measured.stack,
                           "instructions": max(answer[1] for answer in measured.answers)}
    with open(path, "w") as file:
        json.dump(facts, file, indent=2)
        file.write("\n")
    print(json.dumps(facts["cortex_m4f"], indent=2))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
