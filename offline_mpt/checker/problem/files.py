"""Files, and the checksums that tell damaged ones. No statement rests on a checksum."""
import os
import stat
import struct

from exact import Refused, require

# Greatest size of a file that is read whole.
MOST_BYTES = 1 << 33

MASK = (1 << 64) - 1
PRIMES = (11400714785074694791, 14029467366897019727, 1609587929392839161, 9650029242287828579,
          2870177450012600261)
STRIPE = 32


class Unreadable(Exception):
    """A file that cannot be read, which says nothing about what it holds."""


class RefusedFile(Exception):
    """What a file breaks that is not the one to check: the message names it."""


def read_file(path):
    """All bytes of a file or a pipe, at least one."""
    try:
        status = os.stat(path)
    except OSError:
        raise Unreadable(f"{path}: no such file") from None
    if not stat.S_ISREG(status.st_mode) and not stat.S_ISFIFO(status.st_mode):
        raise Unreadable(f"{path}: is no file")
    if status.st_size > MOST_BYTES:
        raise Unreadable(f"{path}: is larger than {MOST_BYTES} bytes")
    try:
        with open(path, "rb") as file:
            content = file.read()
    except OSError:
        content = b""
    if not content:
        raise Unreadable(f"{path}: cannot be read, or is empty")
    return content


def with_file(path, use):
    """What `use` makes of the bytes of a file. What that refuses is said of this file."""
    content = read_file(path)
    try:
        return use(content)
    except Refused as error:
        raise RefusedFile(f"{path}: refused: {error}") from None


def rotated(value, bits):
    value &= MASK
    return (value << bits | value >> (64 - bits)) & MASK


def mixed(state, word):
    return rotated(state + word * PRIMES[1], 31) * PRIMES[0] & MASK


def xxh64(content):
    """With seed 0."""
    value, end = PRIMES[4], len(content) // STRIPE * STRIPE
    if end > 0:
        lanes = [PRIMES[0] + PRIMES[1], PRIMES[1], 0, -PRIMES[0]]
        for words in struct.iter_unpack("<4Q", content[:end]):
            lanes = list(map(mixed, lanes, words))
        value = sum(map(rotated, lanes, (1, 7, 12, 18)))
        for lane in lanes:
            value = (value ^ mixed(0, lane)) * PRIMES[0] + PRIMES[3] & MASK
    value = value + len(content) & MASK
    rest = content[end:]
    for width, mix, bits, factor, added in (
            (8, lambda word: mixed(0, word), 27, PRIMES[0], PRIMES[3]),
            (4, lambda word: word * PRIMES[0] & MASK, 23, PRIMES[1], PRIMES[2]),
            (1, lambda word: word * PRIMES[4] & MASK, 11, PRIMES[0], 0)):
        while len(rest) >= width:
            word, rest = int.from_bytes(rest[:width], "little"), rest[width:]
            value = rotated(value ^ mix(word), bits) * factor + added & MASK
    for shift, factor in ((33, PRIMES[1]), (29, PRIMES[2])):
        value = (value ^ value >> shift) * factor & MASK
    return value ^ value >> 32


def unsealed(content):
    """The lines of a certificate between its first and its last, which has the checksum of all before."""
    require(content.startswith(b"polyfly "), "not a certificate")
    end = content.rfind(b"\nend ")
    require(end >= 0, "the certificate is cut off")
    require(content[end + 1:] == b"end %016x\n" % xxh64(content[:end + 1]),
            "the certificate is damaged: its checksum does not match")
    return content[:end].decode("latin-1").split("\n")
