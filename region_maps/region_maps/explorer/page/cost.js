// The cost of the optimum as a quadratic function of theta in each region, from the program that the page carries.

// Pivots below this share of the greatest entry are zero: the active rows depend on one another.
const kPivotTolerance = 1e-11;
// Residual, as a share of the greatest entry, above which the active set has no solution of this form.
const kResidualTolerance = 1e-7;

// Solves a x = r by elimination with row pivots; unknowns without a pivot are 0. Rows of `table` are [a | r].
// null where a row has no solution.
function solveRows(table, size) {
  const width = table[0].length;
  const scale = table.reduce((most, row) => Math.max(most, ...row.map(Math.abs)), 0);
  const pivot_of = [];
  let used = 0;
  for (let column = 0; column < size; ++column) {
    let best = used;
    for (let i = used; i < table.length; ++i) {
      if (Math.abs(table[i][column]) > Math.abs(table[best][column])) best = i;
    }
    if (used === table.length || Math.abs(table[best][column]) <= kPivotTolerance * scale) continue;
    [table[used], table[best]] = [table[best], table[used]];
    const pivot = table[used];
    for (let i = 0; i < table.length; ++i) {
      const factor = table[i][column] / pivot[column];
      if (i === used || factor === 0) continue;
      for (let j = column; j < width; ++j) table[i][j] -= factor * pivot[j];
    }
    pivot_of[column] = used++;
  }
  for (let i = used; i < table.length; ++i) {
    for (let j = size; j < width; ++j) if (Math.abs(table[i][j]) > kResidualTolerance * scale) return null;
  }
  const solution = [];
  for (let column = 0; column < size; ++column) {
    const row = table[pivot_of[column]];
    const entries = new Float64Array(width - size);
    if (row) for (let j = size; j < width; ++j) entries[j - size] = row[j] / row[column];
    solution.push(entries);
  }
  return solution;
}

class CostFunction {
  constructor(map, program) {
    this.map = map;
    this.equalities = program.equalities;
    this.n = program.variables;
    this.fields = {};
    for (const field of ['H', 'f', 'F', 'A', 'b', 'S', 'rest']) this.fields[field] = decodeNumbers(program[field]);
    this.known = new Map();
  }

  // Symmetric (p + 1) x (p + 1) matrix of the cost in (theta, 1); null where the active set does not tell it.
  of(region) {
    if (!this.known.has(region)) this.known.set(region, this.compute(region));
    return this.known.get(region);
  }

  // z as an affine function of theta: stationarity, and the active rows as equalities.
  optimum(region) {
    const {n} = this;
    const p = this.map.p;
    const {H, f, F, A, b, S} = this.fields;
    const active = Array.from(new Set([...activeOf(this.map, region), ...this.equalities]));
    const size = n + active.length;
    const table = [];
    for (let i = 0; i < size; ++i) table.push(new Float64Array(size + p + 1));
    for (let i = 0; i < n; ++i) {
      for (let j = 0; j < n; ++j) table[i][j] = H[i * n + j];
      for (let j = 0; j < p; ++j) table[i][size + j] = -F[i * p + j];
      table[i][size + p] = -f[i];
    }
    active.forEach((row, k) => {
      for (let j = 0; j < n; ++j) table[n + k][j] = table[j][n + k] = A[row * n + j];
      for (let j = 0; j < p; ++j) table[n + k][size + j] = S[row * p + j];
      table[n + k][size + p] = b[row];
    });
    return solveRows(table, size);
  }

  compute(region) {
    const z = this.optimum(region);
    if (z === null) return null;
    const {n} = this;
    const q = this.map.p + 1;
    const {H, f, F, rest} = this.fields;
    const result = Float64Array.from(rest);
    for (let i = 0; i < n; ++i) {
      // Half of row i of H z, and the linear term, as coefficients of (theta, 1).
      const slope = new Float64Array(q);
      for (let j = 0; j < n; ++j) for (let c = 0; c < q; ++c) slope[c] += 0.5 * H[i * n + j] * z[j][c];
      for (let c = 0; c < q; ++c) slope[c] += c < q - 1 ? F[i * (q - 1) + c] : f[i];
      for (let r = 0; r < q; ++r) {
        for (let c = 0; c < q; ++c) result[r * q + c] += 0.5 * (z[i][r] * slope[c] + slope[r] * z[i][c]);
      }
    }
    return result;
  }

  at(region, theta) {
    const matrix = this.of(region);
    if (matrix === null) return null;
    const q = this.map.p + 1;
    const point = [...theta, 1];
    let sum = 0;
    for (let r = 0; r < q; ++r) for (let c = 0; c < q; ++c) sum += point[r] * matrix[r * q + c] * point[c];
    return sum;
  }
}
