// Slices: the regions, and the cells of the search tree, cut by a plane in which two parameters are free.

// Polygons below this share of the slice's area are not drawn: the slice only touches such a region.
const kLeastArea = 1e-12;

// Keeps the part of a convex polygon (x, y, x, y, ...) where a x + b y <= c.
function clipPolygon(polygon, a, b, c) {
  const kept = [];
  const count = polygon.length;
  let x0 = polygon[count - 2];
  let y0 = polygon[count - 1];
  let d0 = a * x0 + b * y0 - c;
  for (let i = 0; i < count; i += 2) {
    const x1 = polygon[i];
    const y1 = polygon[i + 1];
    const d1 = a * x1 + b * y1 - c;
    if ((d0 <= 0) !== (d1 <= 0)) {
      const share = d0 / (d0 - d1);
      kept.push(x0 + share * (x1 - x0), y0 + share * (y1 - y0));
    }
    if (d1 <= 0) kept.push(x1, y1);
    x0 = x1;
    y0 = y1;
    d0 = d1;
  }
  return kept;
}

function polygonArea(polygon) {
  let twice = 0;
  for (let i = 0; i < polygon.length; i += 2) {
    const j = (i + 2) % polygon.length;
    twice += polygon[i] * polygon[j + 1] - polygon[j] * polygon[i + 1];
  }
  return Math.abs(twice) / 2;
}

// The planes restricted to a slice: a x + b y <= c, with the least and greatest a x + b y - c in the window.
class SlicePlanes {
  constructor(map) {
    const count = map.planes.length / (map.p + 1);
    this.map = map;
    for (const field of ['a', 'b', 'c', 'least', 'greatest']) this[field] = new Float64Array(count);
  }

  // y < 0: the map has one parameter, and the slice is a band of height 1.
  set(x, y, theta) {
    const {map, a, b, c, least, greatest} = this;
    const p = map.p;
    this.x_range = [map.parameters[x].lower, map.parameters[x].upper];
    this.y_range = y < 0 ? [0, 1] : [map.parameters[y].lower, map.parameters[y].upper];
    const [x0, x1] = this.x_range;
    const [y0, y1] = this.y_range;
    for (let k = 0; k < a.length; ++k) {
      const base = k * (p + 1);
      let c_k = map.planes[base + p];
      for (let i = 0; i < p; ++i) {
        if (i !== x && i !== y) c_k -= map.planes[base + i] * theta[i];
      }
      const a_k = map.planes[base + x];
      const b_k = y < 0 ? 0 : map.planes[base + y];
      a[k] = a_k;
      b[k] = b_k;
      c[k] = c_k;
      least[k] = (a_k > 0 ? a_k * x0 : a_k * x1) + (b_k > 0 ? b_k * y0 : b_k * y1) - c_k;
      greatest[k] = (a_k > 0 ? a_k * x1 : a_k * x0) + (b_k > 0 ? b_k * y1 : b_k * y0) - c_k;
    }
  }

  window() {
    const [x0, x1] = this.x_range;
    const [y0, y1] = this.y_range;
    return [x0, y0, x1, y0, x1, y1, x0, y1];
  }

  clip(polygon, row) {
    const k = row > 0 ? row - 1 : -row - 1;
    return row > 0 ? clipPolygon(polygon, this.a[k], this.b[k], this.c[k])
                   : clipPolygon(polygon, -this.a[k], -this.b[k], -this.c[k]);
  }
}

// Whether a row leaves nothing of the window, by its least value there. The tolerance keeps a slice along a facet.
function cutRegion(planes, rows, window) {
  const {least, greatest} = planes;
  const tolerance = planes.map.tolerance;
  for (let i = 0; i < rows.length; ++i) {
    const row = rows[i];
    if ((row > 0 ? least[row - 1] : -greatest[-row - 1]) > tolerance) return null;
  }
  let polygon = window;
  for (let i = 0; i < rows.length; ++i) {
    const row = rows[i];
    const k = row > 0 ? row - 1 : -row - 1;
    // A row that holds in the whole window cuts nothing; one that holds on an edge only within rounding is parallel.
    if ((row > 0 ? greatest[k] : -least[k]) <= tolerance) continue;
    polygon = planes.clip(polygon, row);
    if (polygon.length < 6) return null;
  }
  return polygon;
}

// [{region, polygon}]
function cutMap(planes, x, y, theta) {
  planes.set(x, y, theta);
  const {map} = planes;
  const window = planes.window();
  const least_area = kLeastArea * polygonArea(window);
  const cut = [];
  for (let region = 0; region < map.region_count; ++region) {
    const polygon = cutRegion(planes, rowsOf(map, region), window);
    if (polygon !== null && polygonArea(polygon) > least_area) cut.push({region, polygon});
  }
  return cut;
}

// [{depth, polygon}]: the leaves of the search tree. `planes` belong to the slice already.
function cutTree(planes) {
  const {map} = planes;
  const cells = [];
  const open = [{child: map.root, depth: 0, polygon: planes.window()}];
  while (open.length > 0) {
    const {child, depth, polygon} = open.pop();
    if (child >= kLeaf) {
      cells.push({depth, polygon});
      continue;
    }
    const row = map.nodes[3 * child] + 1;
    const below = planes.clip(polygon, row);
    const above = planes.clip(polygon, -row);
    if (below.length >= 6) open.push({child: map.nodes[3 * child + 1], depth: depth + 1, polygon: below});
    if (above.length >= 6) open.push({child: map.nodes[3 * child + 2], depth: depth + 1, polygon: above});
  }
  return cells;
}
