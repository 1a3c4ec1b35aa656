// The map file as typed arrays: region_maps/FORMAT.md is the specification. The generator has checked the file.

const kLeaf = 0x80000000;
const kAllRows = 0xffffffff;

const kSection = {text: 0, bounds: 1, planes: 2, laws: 3, regions: 4, rows: 5, active: 6, nodes: 7, leaves: 8,
                  candidates: 9, tests: 10};

function decodeBase64(text) {
  const binary = atob(text.trim());
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

function decodeNumbers(text) {
  return new Float64Array(decodeBase64(text).buffer);
}

function readSignals(texts, bounds, first, count) {
  const signals = [];
  for (let i = 0; i < count; ++i) {
    signals.push({name: texts[5 + 2 * (first + i)], unit: texts[6 + 2 * (first + i)],
                  lower: bounds[2 * (first + i)], upper: bounds[2 * (first + i) + 1]});
  }
  return signals;
}

function readMap(bytes) {
  const view = new DataView(bytes.buffer);
  const u32 = (at) => view.getUint32(at, true);
  const u64 = (at) => u32(at) + u32(at + 4) * 4294967296;
  const p = u32(32);
  const m = u32(36);
  const count = (index) => u64(96 + 16 * index + 8);
  const section = (Type, index, width) => new Type(bytes.buffer, u64(96 + 16 * index), count(index) * width);
  const texts = new TextDecoder().decode(section(Uint8Array, kSection.text, 1)).split('\0');
  const bounds = section(Float64Array, kSection.bounds, 2);
  const has_tests = u32(44) > kSection.tests && count(kSection.tests) > 0;
  const region_count = count(kSection.regions);
  return {
    p, m, region_count,
    version: u32(12), root: u32(40), tolerance: view.getFloat64(56, true), depth: u32(64),
    reduced: u64(80) !== 0, law_count: count(kSection.laws),
    name: texts[0], status: texts[3],
    parameters: readSignals(texts, bounds, 0, p), inputs: readSignals(texts, bounds, p, m),
    planes: section(Float64Array, kSection.planes, p + 1), laws: section(Float64Array, kSection.laws, m * (p + 1)),
    regions: section(Uint32Array, kSection.regions, 5), rows: section(Int32Array, kSection.rows, 1),
    active: section(Int32Array, kSection.active, 1), nodes: section(Uint32Array, kSection.nodes, 3),
    leaves: section(Uint32Array, kSection.leaves, 2), candidates: section(Uint32Array, kSection.candidates, 1),
    tests: has_tests ? section(Uint32Array, kSection.tests, 1) : null,
  };
}

function rowsOf(map, region) {
  const first = map.regions[5 * region];
  return map.rows.subarray(first, first + map.regions[5 * region + 1]);
}

function lawOf(map, region) {
  return map.regions[5 * region + 2];
}

function activeOf(map, region) {
  const first = map.regions[5 * region + 3];
  return map.active.subarray(first, first + map.regions[5 * region + 4]);
}
