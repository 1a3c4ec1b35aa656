// One slice on a canvas: filled polygons, their outlines, axes, and what moves above them.

// Pixels of a device that are drawn for one of the page at most.
const kMostDensity = 2;
const kMargin = {left: 58, right: 10, top: 8, bottom: 44};
const kOutlineOpacity = 0.34;

// Fills each polygon row by row; `valueColour` of a value, or one colour for the polygon.
class PolygonPainter {
  constructor(width, height, x_range, y_range) {
    this.width = width;
    this.height = height;
    this.image = new ImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.left = new Float64Array(height);
    this.right = new Float64Array(height);
    this.x_scale = width / (x_range[1] - x_range[0]);
    this.y_scale = height / (y_range[1] - y_range[0]);
    this.x_lower = x_range[0];
    this.y_upper = y_range[1];
  }

  // Rows of pixels whose middles the polygon holds; their ends are in left and right.
  findRows(polygon) {
    const {left, right} = this;
    let top = Infinity;
    let bottom = -Infinity;
    for (let i = 0; i < polygon.length; i += 2) {
      const row = (this.y_upper - polygon[i + 1]) * this.y_scale;
      top = Math.min(top, row);
      bottom = Math.max(bottom, row);
    }
    const first = Math.max(0, Math.ceil(top - 0.5));
    const last = Math.min(this.height - 1, Math.ceil(bottom - 0.5) - 1);
    for (let j = first; j <= last; ++j) {
      left[j] = Infinity;
      right[j] = -Infinity;
    }
    for (let i = 0; i < polygon.length; i += 2) {
      const k = (i + 2) % polygon.length;
      this.walkEdge((polygon[i] - this.x_lower) * this.x_scale, (this.y_upper - polygon[i + 1]) * this.y_scale,
                    (polygon[k] - this.x_lower) * this.x_scale, (this.y_upper - polygon[k + 1]) * this.y_scale);
    }
    return [first, last];
  }

  walkEdge(x0, y0, x1, y1) {
    const {left, right} = this;
    const first = Math.max(0, Math.ceil(Math.min(y0, y1) - 0.5));
    const last = Math.min(this.height - 1, Math.ceil(Math.max(y0, y1) - 0.5) - 1);
    if (first > last) return;
    const slope = (x1 - x0) / (y1 - y0);
    for (let j = first; j <= last; ++j) {
      const x = x0 + (j + 0.5 - y0) * slope;
      if (x < left[j]) left[j] = x;
      if (x > right[j]) right[j] = x;
    }
  }

  fillFlat(polygon, colour) {
    const [first, last] = this.findRows(polygon);
    for (let j = first; j <= last; ++j) {
      const from = Math.max(0, Math.ceil(this.left[j] - 0.5));
      const to = Math.min(this.width, Math.ceil(this.right[j] - 0.5));
      if (from < to) this.pixels.fill(colour, j * this.width + from, j * this.width + to);
    }
  }

  fillQuadratic(polygon, c, scale) {
    const [first, last] = this.findRows(polygon);
    const {table, lower, upper, bent} = scale;
    const factor = 1 / (upper - lower);
    const top = table.length - 1;
    for (let j = first; j <= last; ++j) {
      const from = Math.max(0, Math.ceil(this.left[j] - 0.5));
      const to = Math.min(this.width, Math.ceil(this.right[j] - 0.5));
      const y = this.y_upper - (j + 0.5) / this.y_scale;
      const c0 = c[0] + y * (c[2] + c[5] * y) - lower;
      const c1 = c[1] + c[4] * y;
      for (let i = from; i < to; ++i) {
        const x = this.x_lower + (i + 0.5) / this.x_scale;
        let share = (c0 + x * (c1 + c[3] * x)) * factor;
        if (bent) share = share > 0 ? Math.sqrt(share) : 0;
        const step = share * top + 0.5;
        this.pixels[j * this.width + i] = table[step > top ? top : step > 0 ? step | 0 : 0];
      }
    }
  }
}

// About `count` round numbers in a range.
function ticks([lower, upper], count) {
  const raw = (upper - lower) / count;
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= raw) || 10 * power;
  const result = [];
  for (let k = Math.ceil(lower / step - 1e-9); k * step <= upper + 1e-9 * step; ++k) result.push(k * step);
  return result;
}

function formatNumber(value, digits = 4) {
  if (value === 0) return '0';
  return String(Number(value.toPrecision(digits))).replace('-', '\u2212');
}

function withUnit(signal) {
  return signal.unit === '' ? signal.name : `${signal.name} [${signal.unit}]`;
}

class SliceView {
  constructor(canvas, margin) {
    this.canvas = canvas;
    this.margin = margin || {left: 0, right: 0, top: 0, bottom: 0};
    this.base = document.createElement('canvas');
    this.key = '';
    this.x = 0;
    this.y = 1;
    this.cut = [];
  }

  // False where the canvas has no size yet.
  resize() {
    const box = this.canvas.getBoundingClientRect();
    this.density = Math.min(window.devicePixelRatio || 1, kMostDensity);
    this.width = Math.max(0, Math.round(box.width));
    this.height = Math.max(0, Math.round(box.height));
    const {left, right, top, bottom} = this.margin;
    this.plot = {left, top, width: this.width - left - right, height: this.height - top - bottom};
    if (this.plot.width < 4 || this.plot.height < 4) return false;
    for (const canvas of [this.canvas, this.base]) {
      canvas.width = Math.round(this.width * this.density);
      canvas.height = Math.round(this.height * this.density);
    }
    return true;
  }

  toPixel(x, y) {
    const [x0, x1] = this.x_range;
    const [y0, y1] = this.y_range;
    return [this.plot.left + (x - x0) / (x1 - x0) * this.plot.width,
            this.plot.top + (y1 - y) / (y1 - y0) * this.plot.height];
  }

  // Values of x and y below a pointer, within the window.
  fromPointer(event) {
    const box = this.canvas.getBoundingClientRect();
    const share = (value) => Math.max(0, Math.min(1, value));
    const across = share((event.clientX - box.left - this.plot.left) / this.plot.width);
    const down = share((event.clientY - box.top - this.plot.top) / this.plot.height);
    const [x0, x1] = this.x_range;
    const [y0, y1] = this.y_range;
    return [x0 + across * (x1 - x0), y1 - down * (y1 - y0)];
  }

  // `fill` paints the polygons into a PolygonPainter.
  drawBase(planes, cut, fill, style) {
    this.cut = cut;
    this.x_range = planes.x_range.slice();
    this.y_range = planes.y_range.slice();
    const {plot, density} = this;
    const painter = new PolygonPainter(Math.round(plot.width * density), Math.round(plot.height * density),
                                       this.x_range, this.y_range);
    fill(painter);
    const context = this.base.getContext('2d');
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.base.width, this.base.height);
    context.putImageData(painter.image, Math.round(plot.left * density), Math.round(plot.top * density));
    context.setTransform(density, 0, 0, density, 0, 0);
    context.globalAlpha = style.outline;
    context.strokeStyle = style.ink;
    context.lineWidth = this.margin.left > 0 ? 0.8 : 0.5;
    context.stroke(this.outlines());
    context.globalAlpha = 1;
  }

  outlines() {
    const path = new Path2D();
    for (const {polygon} of this.cut) this.addPolygon(path, polygon);
    return path;
  }

  addPolygon(path, polygon) {
    for (let i = 0; i < polygon.length; i += 2) {
      const [px, py] = this.toPixel(polygon[i], polygon[i + 1]);
      if (i === 0) path.moveTo(px, py);
      else path.lineTo(px, py);
    }
    path.closePath();
  }

  // Copies the base and returns the context to draw above it.
  begin() {
    const context = this.canvas.getContext('2d');
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.drawImage(this.base, 0, 0);
    context.setTransform(this.density, 0, 0, this.density, 0, 0);
    return context;
  }

  drawAxes(context, labels, style) {
    const {plot} = this;
    context.font = style.font;
    context.fillStyle = style.ink;
    context.strokeStyle = style.ink;
    context.lineWidth = 1;
    context.textAlign = 'center';
    context.textBaseline = 'top';
    const bottom = plot.top + plot.height;
    for (const tick of ticks(this.x_range, 6)) {
      const [px] = this.toPixel(tick, this.y_range[0]);
      context.fillRect(px - 0.5, bottom, 1, 4);
      context.fillText(formatNumber(tick), px, bottom + 7);
    }
    context.fillText(labels.x, plot.left + plot.width / 2, bottom + 25);
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    const [y0, y1] = labels.y_range;
    for (const tick of ticks(labels.y_range, 6)) {
      const py = plot.top + (y1 - tick) / (y1 - y0) * plot.height;
      context.fillRect(plot.left - 4, py - 0.5, 4, 1);
      context.fillText(formatNumber(tick), plot.left - 8, py);
    }
    context.save();
    context.translate(12, plot.top + plot.height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = 'center';
    context.fillText(labels.y, 0, 0);
    context.restore();
    context.strokeRect(plot.left - 0.5, plot.top - 0.5, plot.width + 1, plot.height + 1);
  }

  clipToPlot(context) {
    const {plot} = this;
    context.save();
    context.beginPath();
    context.rect(plot.left, plot.top, plot.width, plot.height);
    context.clip();
  }

  // A line with a border, so that it shows on any colour.
  drawLine(context, points, width, style) {
    if (points.length < 2) return;
    context.lineJoin = 'round';
    context.beginPath();
    points.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.strokeStyle = style.surface;
    context.lineWidth = width + 2;
    context.stroke();
    context.strokeStyle = style.ink;
    context.lineWidth = width;
    context.stroke();
  }

  drawDot(context, [x, y], radius, fill, style) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = fill;
    context.fill();
    context.strokeStyle = style.surface;
    context.lineWidth = 1.5;
    context.stroke();
  }

  drawCross(context, [x, y], style) {
    const {plot} = this;
    context.strokeStyle = style.ink;
    context.globalAlpha = 0.55;
    context.lineWidth = 1;
    context.setLineDash([3, 3]);
    context.beginPath();
    context.moveTo(x, plot.top);
    context.lineTo(x, plot.top + plot.height);
    context.moveTo(plot.left, y);
    context.lineTo(plot.left + plot.width, y);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }
}
