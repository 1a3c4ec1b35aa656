# shellcheck shell=bash
# A map of more than a million regions of four parameters. Takes about 10 minutes, 4 GB of memory and 1.4 GB of disk.
/usr/bin/python3 test/bench/million.py "$output"
