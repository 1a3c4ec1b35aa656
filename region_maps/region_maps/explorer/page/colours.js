// Colour scales, and what a colour of a slice means.

const kScaleSteps = 256;
const kGoldenAngle = 137.508;

const kScales = {
  light: {
    diverging: ['#1f5a8c', '#7fb0d2', '#f5f2ea', '#e8a774', '#a64a17'],
    sequential: ['#faf6e9', '#c4dfc6', '#74b3a4', '#2f7a8c', '#173f63'],
    missing: '#dcdad4',
  },
  dark: {
    diverging: ['#6db7ef', '#2f6288', '#23272e', '#8a5330', '#f0a05f'],
    sequential: ['#20252c', '#22495c', '#2b7a80', '#7cc1a0', '#f2e9ab'],
    missing: '#3a3d44',
  },
  contrast: {
    diverging: ['#00459c', '#6aa6ff', '#ffffff', '#ffb060', '#a83200'],
    sequential: ['#ffffff', '#a8d8ff', '#3c94dc', '#0b4f9c', '#001a40'],
    missing: '#b0b0b0',
  },
};

function parseColour(text) {
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
}

// A pixel of ImageData on a little-endian machine.
function packColour([red, green, blue]) {
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

// kScaleSteps pixels from the first colour to the last.
function scaleTable(colours) {
  const stops = colours.map(parseColour);
  const table = new Uint32Array(kScaleSteps);
  for (let i = 0; i < kScaleSteps; ++i) {
    const place = i / (kScaleSteps - 1) * (stops.length - 1);
    const stop = Math.min(Math.floor(place), stops.length - 2);
    const share = place - stop;
    table[i] = packColour(stops[stop].map((from, k) => Math.round(from + share * (stops[stop + 1][k] - from))));
  }
  return table;
}

function cssOf(pixel) {
  return `rgb(${pixel & 255},${(pixel >> 8) & 255},${(pixel >> 16) & 255})`;
}

// A hue [degrees] of low saturation; lightness and saturation 0..1.
function hueColour(hue, lightness, saturation) {
  const chroma = saturation * (1 - Math.abs(2 * lightness - 1));
  const channel = (shift) => {
    const place = (((hue + shift) % 360) + 360) % 360 / 60;
    const strength = Math.max(0, Math.min(1, Math.abs(place - 3) - 1));
    return Math.round(255 * (lightness + chroma * (strength - 0.5)));
  };
  return packColour([channel(0), channel(240), channel(120)]);
}

// Number of each region's active set among the distinct ones.
function numberActiveSets(map) {
  const numbers = new Map();
  const of_region = new Int32Array(map.region_count);
  let most = 0;
  for (let region = 0; region < map.region_count; ++region) {
    const active = activeOf(map, region);
    const key = active.join();
    if (!numbers.has(key)) numbers.set(key, numbers.size);
    of_region[region] = numbers.get(key);
    most = Math.max(most, active.length);
  }
  return {of_region, most, count: numbers.size};
}

// A function of theta that is quadratic in the slice's x and y: [1, x, y, xx, xy, yy].
function restrictAffine(coefficients, base, p, x, y, theta) {
  let rest = coefficients[base + p];
  for (let i = 0; i < p; ++i) if (i !== x && i !== y) rest += coefficients[base + i] * theta[i];
  return [rest, coefficients[base + x], y < 0 ? 0 : coefficients[base + y], 0, 0, 0];
}

function restrictQuadratic(matrix, p, x, y, theta) {
  const q = p + 1;
  const fixed = [...theta, 1];
  fixed[x] = 0;
  if (y >= 0) fixed[y] = 0;
  const along = (row) => fixed.reduce((sum, value, c) => sum + matrix[row * q + c] * value, 0);
  const rest = fixed.reduce((sum, value, r) => sum + (value === 0 ? 0 : value * along(r)), 0);
  if (y < 0) return [rest, 2 * along(x), 0, matrix[x * q + x], 0, 0];
  return [rest, 2 * along(x), 2 * along(y), matrix[x * q + x], 2 * matrix[x * q + y], matrix[y * q + y]];
}

function evaluateRestricted(c, x, y) {
  return c[0] + x * (c[1] + c[3] * x + c[4] * y) + y * (c[2] + c[5] * y);
}

// Least and greatest value at the corners of the polygons.
function rangeAtCorners(items, coefficients) {
  let lower = Infinity;
  let upper = -Infinity;
  items.forEach(({polygon}, k) => {
    if (coefficients[k] === null) return;
    for (let i = 0; i < polygon.length; i += 2) {
      const value = evaluateRestricted(coefficients[k], polygon[i], polygon[i + 1]);
      lower = Math.min(lower, value);
      upper = Math.max(upper, value);
    }
  });
  if (!(lower <= upper)) return [0, 1];
  return lower < upper ? [lower, upper] : [lower - 0.5, upper + 0.5];
}

// A range around 0, so that the middle colour means 0, where the range holds 0.
function aroundZero([lower, upper]) {
  if (lower >= 0 || upper <= 0) return [lower, upper];
  const size = Math.max(-lower, upper);
  return [-size, size];
}
