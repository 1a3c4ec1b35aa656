"""The command line of a checker, its exit codes, and what it says."""
import os
import re
import signal
import sys
import time

from exact import Refused
from files import RefusedFile, Unreadable

CONFIRMED, REFUSED, BAD_USAGE, STOPPED = range(4)
TIME_LIMIT = "--time-limit"
# Three years, in seconds.
LONGEST_LIMIT = 100_000_000
# Characters of a value that a message repeats.
MOST_SHOWN = 40


class BadUsage(Exception):
    """What a command line says that breaks a rule."""


def shown(text):
    return f"'{text[:MOST_SHOWN]}{'..' if len(text) > MOST_SHOWN else ''}'"


def say(name, text):
    """One line, without what a terminal would act on."""
    print(f"{name}: {re.sub('[^ -~]', '?', text)}", file=sys.stderr)


def read_arguments(words, options):
    """Values by option; the file that is checked stands under ""."""
    arguments, words = {}, iter(words)
    for word in words:
        is_option = word == TIME_LIMIT or word in options
        if not is_option and word.startswith("-"):
            raise BadUsage(f"{shown(word)} is no option")
        if not is_option and "" in arguments:
            raise BadUsage(f"{shown(word)}: one file is checked at a time")
        value = next(words, "") if is_option else word
        if is_option and not value:
            raise BadUsage(f"{word}: its value is missing")
        arguments[word if is_option else ""] = value
    if not arguments.get(""):
        raise BadUsage("the file to check is missing")
    return arguments


def limit_time(name, text):
    if not re.fullmatch("[0-9]{1,18}", text) or not 1 <= int(text) <= LONGEST_LIMIT:
        raise BadUsage(f"{TIME_LIMIT}: {shown(text)} is not a whole number from 1 to {LONGEST_LIMIT}")

    def end_in_time(*_):
        os.write(sys.stderr.fileno(), f"{name}: stopped at the time limit, nothing is confirmed\n".encode())
        os._exit(STOPPED)

    signal.signal(signal.SIGALRM, end_in_time)
    signal.alarm(int(text))


class Progress:
    """Tells on a terminal, once a second, how far a check is."""

    def __init__(self):
        self._next = time.monotonic() + 1

    def __call__(self, kind, done, total):
        if time.monotonic() >= self._next and sys.stderr.isatty():
            self._next = time.monotonic() + 1
            print(f"{kind} {done} of {total}", file=sys.stderr)


def write_out(text):
    """Whole, and without a buffer that fails again at the end."""
    content = text.encode()
    try:
        while content:
            content = content[os.write(1, content):]
    except OSError:
        raise Unreadable("the standard output cannot be written") from None


def run(name, version, usage, options, check):
    """Reads the command line and checks; `check` returns what is confirmed. The exit code is that of the usage."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    arguments = {}
    try:
        words = sys.argv[1:]
        if "--help" in words or "--version" in words:
            write_out(usage if "--help" in words else f"{name} {version}\n")
            return CONFIRMED
        arguments = read_arguments(words, options)
        if TIME_LIMIT in arguments:
            limit_time(name, arguments[TIME_LIMIT])
        write_out(check(arguments))
        return CONFIRMED
    except BadUsage as error:
        say(name, f"{error} (see {name} --help)")
    except Unreadable as error:
        say(name, str(error))
    except MemoryError:
        say(name, "out of memory")
    except RefusedFile as error:
        say(name, str(error))
        return REFUSED
    except Refused as error:
        say(name, f"{arguments['']}: refused: {error}")
        return REFUSED
    except Exception as error:  # what is not as any rule expects it is not confirmed
        say(name, f"{arguments['']}: refused: cannot be read ({type(error).__name__}: {error})")
        return REFUSED
    return BAD_USAGE
