"""Time and memory of the tools on a bag of a gigabyte: the demo's flight among pictures. Prints rows of a benchmark."""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time

import genpy
import rosbag
from sensor_msgs.msg import Image

GIGABYTE = 10 ** 9
PICTURE = 640 * 480 * 3


def write_bag(flight, path, compression):
    """The flight's messages, and before each so many pictures that the file passes a gigabyte."""
    block = os.urandom(1 << 20) + bytes(1 << 20)  # half of it can be packed
    picture = Image(height=480, width=640, encoding="rgb8", step=640 * 3)
    with rosbag.Bag(flight) as source, rosbag.Bag(path, "w", compression=compression) as target:
        messages = source.get_message_count()
        pictures = 0
        for number, (topic, raw, stamp) in enumerate(source.read_messages(raw=True)):
            while pictures * PICTURE < GIGABYTE * (number + 1) / messages:
                start = (pictures * 7919) % (len(block) - PICTURE)
                picture.data = block[start:start + PICTURE]
                picture.header.stamp = genpy.Time(stamp.secs, stamp.nsecs)
                target.write("/camera/image", picture, stamp)
                pictures += 1
            target.write(topic, raw, stamp, raw=True)


def measure(command):
    """Wall time [s], and greatest memory [MB] of the largest child so far."""
    begin = time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.monotonic() - begin, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1000.0


def main():
    flight, maps = sys.argv[1], sys.argv[2:]
    rows = []
    with tempfile.TemporaryDirectory(dir=os.path.dirname(flight)) as folder:
        for compression in ("none", "lz4"):
            path = os.path.join(folder, "large.bag")
            write_bag(flight, path, compression)
            for name, command in (
                    ("calibrate", ["build/bin/calibrate", "attitude", path, "--axis", "roll", "--quiet"]),
                    ("validate_bag", ["build/bin/validate_bag", "--bag", path, "--map", *maps, "--options",
                                      "launch/config/firefly.yaml", "--min-coverage", "0", "--quiet"])):
                seconds, megabytes = measure(command)
                rows.append({"name": f"{name}: bag of 1 GB, {compression}", "value": round(seconds, 2), "unit": "s",
                             "mark": 60, "reached": seconds < 60})
                rows.append({"name": f"{name}: bag of 1 GB, {compression}, memory", "value": round(megabytes, 1),
                             "unit": "MB", "mark": 500, "reached": megabytes < 500})
            os.remove(path)
    print(json.dumps(rows, indent=1))


main()
