// Point location as FORMAT.md has it. Sums are added in the order of point_location.cpp, so that the answer is the same.

// Greatest number of parameters for which the reader adds terms by halves; beyond it adds them in order.
const kHalvedParameters = 8;

function sumTerms(planes, base, theta, p, first, end) {
  if (end - first > 1) {
    const middle = (first + end + 1) >> 1;
    return sumTerms(planes, base, theta, p, first, middle) + sumTerms(planes, base, theta, p, middle, end);
  }
  return first < p ? planes[base + first] * theta[first] : -planes[base + first];
}

// a . theta - c of a plane [scaled].
function planeDistance(map, plane, theta) {
  const base = plane * (map.p + 1);
  if (map.p <= kHalvedParameters) return sumTerms(map.planes, base, theta, map.p, 0, map.p + 1);
  let sum = 0;
  for (let i = 0; i < map.p; ++i) sum += map.planes[base + i] * theta[i];
  return sum - map.planes[base + map.p];
}

function rowDistance(map, row, theta) {
  return row > 0 ? planeDistance(map, row - 1, theta) : -planeDistance(map, -row - 1, theta);
}

function isTested(tests, row) {
  return ((tests >>> Math.min(row, 31)) & 1) !== 0;
}

// Greatest violation of the rows that `tests` names; infinite beyond the tolerance.
function violation(map, region, tests, theta) {
  const rows = rowsOf(map, region);
  let greatest = -Infinity;
  for (let i = 0; i < rows.length; ++i) {
    if (!isTested(tests, i)) continue;
    const beyond = rowDistance(map, rows[i], theta);
    if (!(beyond <= map.tolerance)) return Infinity;
    if (beyond > greatest) greatest = beyond;
  }
  return greatest;
}

function boxStatus(map, theta) {
  let status = 'inside';
  for (let i = 0; i < map.p; ++i) {
    if (!Number.isFinite(theta[i])) return 'not finite';
    const signal = map.parameters[i];
    const margin = map.tolerance * 0.5 * (signal.upper - signal.lower);
    if (theta[i] < signal.lower - margin || theta[i] > signal.upper + margin) status = 'outside the box';
  }
  return status;
}

// {status, region, depth}: the region that holds theta, and the number of nodes on the path to its leaf.
function locate(map, theta) {
  const status = boxStatus(map, theta);
  if (status !== 'inside') return {status, region: -1, depth: 0};
  let child = map.root;
  let depth = 0;
  for (; child < kLeaf; ++depth) {
    const node = 3 * child;
    child = map.nodes[planeDistance(map, map.nodes[node], theta) <= 0 ? node + 1 : node + 2];
  }
  const leaf = 2 * (child - kLeaf);
  const first = map.leaves[leaf];
  const end = first + map.leaves[leaf + 1];
  let best = -1;
  let least = Infinity;
  for (let i = first; i < end && !(least <= 0); ++i) {
    const region = map.candidates[i];
    const beyond = violation(map, region, map.tests ? map.tests[i] : kAllRows, theta);
    if (beyond < least) {
      least = beyond;
      best = region;
    }
  }
  return {status: best < 0 ? 'outside the partition' : 'inside', region: best, depth};
}

// u = K theta + k of a law.
function applyLaw(map, law, theta) {
  const u = [];
  for (let j = 0; j < map.m; ++j) {
    const row = (law * map.m + j) * (map.p + 1);
    let sum = map.laws[row + map.p];
    for (let i = 0; i < map.p; ++i) sum += map.laws[row + i] * theta[i];
    u.push(sum);
  }
  return u;
}

// The row of a region that is nearest to theta, and its distance [scaled]; null without rows.
function nearestFacet(map, region, theta) {
  let nearest = null;
  for (const row of rowsOf(map, region)) {
    const distance = -rowDistance(map, row, theta);
    if (nearest === null || distance < nearest.distance) nearest = {row, distance};
  }
  return nearest;
}
