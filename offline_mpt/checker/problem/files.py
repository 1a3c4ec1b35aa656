"""Files, and the checksums that tell damaged ones. No statement rests on a checksum."""
import os
import stat
import struct

from exact import Refused, require

# Greatest size of a file that is read whole.
MOST_BYTES = 1 << 33

MASK = (1 << 64) - 1
PRIMES = (11400714785074694791, 14029467366897019727, 1609587929392839161, 9650029242287828579, 2870177450012600261)
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
    return (value << bits | value >> (64 - bits)) & MASK


def mixed(state, word):
    return rotated((state + word * PRIMES[1]) & MASK, 31) * PRIMES[0] & MASK


def mixed_stripes(content):
    """The four lanes of xxh64 over all whole stripes."""
    first, second, third, fourth = PRIMES[0] + PRIMES[1] & MASK, PRIMES[1], 0, -PRIMES[0] & MASK
    for a, b, c, d in struct.iter_unpack("<4Q", content[:len(content) // STRIPE * STRIPE]):
        first, second, third, fourth = mixed(first, a), mixed(second, b), mixed(third, c), mixed(fourth, d)
    return first, second, third, fourth


def xxh64(content):
    """With seed 0."""
    value = PRIMES[4]
    if len(content) >= STRIPE:
        lanes = mixed_stripes(content)
        value = sum(map(rotated, lanes, (1, 7, 12, 18))) & MASK
        for lane in lanes:
            value = ((value ^ mixed(0, lane)) * PRIMES[0] + PRIMES[3]) & MASK
    value = (value + len(content)) & MASK
    rest = content[len(content) // STRIPE * STRIPE:]
    while len(rest) >= 8:
        value = (rotated(value ^ mixed(0, int.from_bytes(rest[:8], "little")), 27) * PRIMES[0] + PRIMES[3]) & MASK
        rest = rest[8:]
    if len(rest) >= 4:
        word = int.from_bytes(rest[:4], "little") * PRIMES[0] & MASK
        value = (rotated(value ^ word, 23) * PRIMES[1] + PRIMES[2]) & MASK
        rest = rest[4:]
    for byte in rest:
        value = rotated(value ^ (byte * PRIMES[4] & MASK), 11) * PRIMES[0] & MASK
    value = (value ^ value >> 33) * PRIMES[1] & MASK
    value = (value ^ value >> 29) * PRIMES[2] & MASK
    return value ^ value >> 32


def unsealed(content):
    """The lines of a certificate before the last, which has their checksum."""
    require(content.startswith(b"polyfly "), "not a certificate")
    end = content.rfind(b"\nend ")
    require(end >= 0, "the certificate is cut off")
    require(content[end + 1:] == b"end %016x\n" % xxh64(content[:end + 1]),
            "the certificate is damaged: its checksum does not match")
    return content[:end].decode("latin-1")
