"""Maps and certificates that offline_mpt makes, for tests of the checker."""
import os
import subprocess
import tempfile

from certificate import read_certificate
from exact import Refused
from files import xxh64
from region_map import RegionMap

PROGRAM = os.environ["OFFLINE_MPT_PROGRAM"]


class ProvenMap:
    """The map of a problem, as bytes, and what `verify --exact` says of it and proves."""

    def __init__(self, text, ending=".yaml"):
        with tempfile.TemporaryDirectory() as folder:
            problem, path, proof = (os.path.join(folder, "made" + end) for end in (ending, ".map", ".cert"))
            with open(problem, "w", encoding="utf-8") as file:
                file.write(text)
            subprocess.run([PROGRAM, "solve", "--quiet", "--force", problem, "-o", path], check=True, capture_output=True)
            verified = subprocess.run([PROGRAM, "verify", path, "--exact", "--certificate", proof], capture_output=True, text=True)
            self.is_proven, self.said = verified.returncode == 0, verified.stdout + verified.stderr
            with open(path, "rb") as file:
                self.content = file.read()
            self.map = RegionMap(self.content)
            self.certificate = b""
            if os.path.exists(proof):
                with open(proof, "rb") as file:
                    self.certificate = file.read()

    @property
    def lines(self):
        """Those of the certificate, without its checksum."""
        return self.certificate.decode().split("\n")[:-2]

    def read(self, lines=None):
        """The certificate, perhaps of other lines."""
        return read_certificate(self.certificate if lines is None else sealed(lines), self.map)


def sealed(lines):
    content = "".join(line + "\n" for line in lines).encode()
    return content + b"end %016x\n" % xxh64(content)


def refusal_of(check, *arguments):
    """Empty: the check refuses nothing. Else its rule."""
    try:
        check(*arguments)
    except Refused as error:
        return str(error)
    return ""


def replaced(text, start, end):
    assert start in text, start
    return text.replace(start, end, 1)
