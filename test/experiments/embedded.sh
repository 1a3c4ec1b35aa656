# shellcheck shell=bash
# TinyMPC's microcontroller benchmark, answered: the program as a map, and as an online solver in C. Both are flown in closed
# loop, and their instructions are counted on an emulated Cortex-M4 on the same 190 inputs.
rm -rf "$output"
mkdir -p "$output/report"
for tool in arm-none-eabi-gcc qemu-system-arm; do
  command -v "$tool" > /dev/null || { echo "this experiment needs $tool (gcc-arm-none-eabi, qemu-system-arm)" >&2; return 1; }
done
python3 test/experiments/embedded_program.py "$output/filter.json" || return
build/bin/offline_mpt solve "$output/filter.json" -o "$output/filter.map" || return
build/bin/offline_mpt export "$output/filter.map" -o "$output/map_double" --name filter || return
for type in double float; do
  build/bin/offline_mpt export "$output/filter.map" -o "$output/online_$type" --name filter --online --type $type || return
done
python3 test/experiments/embedded.py "$output"
