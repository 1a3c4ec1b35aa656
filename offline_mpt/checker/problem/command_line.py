"""The command line of a checker, its exit codes, and what it says."""
import argparse
import os
import re
import signal
import sys

from exact import Refused
from files import RefusedFile, Unreadable

CONFIRMED, REFUSED, BAD_USAGE, STOPPED = range(4)
# Three years, in seconds.
LONGEST_LIMIT = 100_000_000


class BadUsage(Exception):
    """What a command line says that breaks a rule."""


class Parser(argparse.ArgumentParser):
    """One file, options of a value each, and --time-limit."""

    def __init__(self, usage, version, options):
        super().__init__(add_help=False, allow_abbrev=False)
        self._usage = usage
        self.add_argument("--help", action="help")
        self.add_argument("--version", action="version", version=version)
        self.add_argument("--time-limit", type=seconds_of)
        self.add_argument("file", type=filled)
        for option, is_required in options.items():
            self.add_argument(option, required=is_required, type=filled)

    def format_help(self):
        return self._usage

    def error(self, message):
        raise BadUsage(message)


def filled(text):
    if not text:
        raise argparse.ArgumentTypeError("is empty")
    return text


def seconds_of(text):
    if not re.fullmatch("[0-9]{1,18}", text) or not 1 <= int(text) <= LONGEST_LIMIT:
        raise argparse.ArgumentTypeError(f"'{text[:40]}' is not a whole number from 1 to {LONGEST_LIMIT}")
    return int(text)


def limit_time(name, seconds):
    def end_in_time(*_):
        say(name, "stopped at the time limit, nothing is confirmed")
        os._exit(STOPPED)

    signal.signal(signal.SIGALRM, end_in_time)
    signal.alarm(seconds)


def say(name, text):
    """One line, without what a terminal would act on."""
    os.write(sys.stderr.fileno(), f"{name}: {re.sub('[^ -~]', '?', text)}\n".encode())


def write_out(text):
    """Whole, and without a buffer that fails again at the end."""
    content = text.encode()
    try:
        while content:
            content = content[os.write(sys.stdout.fileno(), content):]
    except (OSError, AttributeError):
        raise Unreadable("the standard output cannot be written") from None


def checked(name, parser, check):
    """The exit code. Reads the command line and checks; `check` returns what is confirmed."""
    arguments = None
    try:
        arguments = parser.parse_args()
        if arguments.time_limit:
            limit_time(name, arguments.time_limit)
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
        say(name, f"{arguments.file}: refused: {error}")
        return REFUSED
    except Exception as error:  # what is not as any rule expects it is not confirmed
        say(name, f"{arguments.file}: refused: cannot be read ({type(error).__name__}: {error})")
        return REFUSED
    return BAD_USAGE
