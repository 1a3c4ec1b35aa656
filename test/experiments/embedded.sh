# shellcheck shell=bash
# TinyMPC's microcontroller benchmark, answered: the program as a map, and as an online solver in C. Both are flown in closed
# loop, and their instructions are counted on an emulated Cortex-M4 on the same 190 inputs. Beside them the filter of (state, wish)
# with its invariant set of states.
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
# The filter of (state, wish). The caller limits the wish to the range of the input. The set of float counts on the error of
# the code.
problems=region_maps/problems/safety
sed -e 's/, wish: \[-50, 50\]//' "$problems/double_integrator.yaml" > "$output/safe_double.yaml"
cp "$problems/double_integrator_float.yaml" "$output/safe_float.yaml"
for type in double float; do
  build/bin/offline_mpt solve "$output/safe_$type.yaml" -o "$output/safe_$type.map" || return
  build/bin/offline_mpt verify "$output/safe_$type.map" --exact || return
  build/bin/offline_mpt export "$output/safe_$type.map" -o "$output/safe_$type" --name filter --type "$type" || return
  python3 test/experiments/measure_export.py "$output/safe_$type" || return
done
python3 test/experiments/embedded.py "$output"
