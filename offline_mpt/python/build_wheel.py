"""What pip calls to build the module: CMake, then a wheel of what CMake leaves. It needs the packages of `./run install`."""
import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def digest(data):
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")


def write_wheel(build, folder):
    """The module of a folder of CMake, as a wheel in a folder; the wheel's name."""
    cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
    version = re.search("^CMAKE_PROJECT_VERSION:STATIC=(.*)$", cache, re.MULTILINE)[1]
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"
    about = f"polyfly-{version}.dist-info"
    files = {f"polyfly/{path.name}": path.read_bytes() for path in sorted((build / "python" / "polyfly").glob("*.*"))}
    files[f"{about}/METADATA"] = (f"Metadata-Version: 2.1\nName: polyfly\nVersion: {version}\nSummary: Explicit and online MPC\n"
                                  "License: BSD-3-Clause\nRequires-Dist: numpy\n").encode()
    files[f"{about}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: polyfly\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = [f"{name},{digest(data)},{len(data)}\n" for name, data in files.items()]
    files[f"{about}/RECORD"] = ("".join(record) + f"{about}/RECORD,,\n").encode()
    name = f"polyfly-{version}-{tag}.whl"
    with zipfile.ZipFile(pathlib.Path(folder) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            wheel.writestr(path, data)
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Hook of PEP 517."""
    build = ROOT / "build" / "pip"
    os.environ.setdefault("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count()))
    # By it pip hides the system's packages, of which CMake looks for NumPy.
    os.environ.pop("PYTHONPATH", None)
    options = ["-DBUILD_TESTING=OFF", f"-DPython3_EXECUTABLE={sys.executable}"]
    subprocess.run(["cmake", "-G", "Ninja", "-S", ROOT, "-B", build, *options], check=True)
    subprocess.run(["cmake", "--build", build, "--target", "polyfly_python"], check=True)
    return write_wheel(build, wheel_directory)
