# shellcheck shell=bash
# The offline toolchain beside a peer: time, regions, samples, look-ups, trees, certificates, memory. README.md tells how
# to measure the peer in the same run. Takes about half an hour with the reference problems and a peer, a minute without.
python3 test/bench/offline.py "$output"
