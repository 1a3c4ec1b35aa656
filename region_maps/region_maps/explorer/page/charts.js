// Signals over time, one small chart each.

const kChartMargin = {left: 46, right: 8, top: 6, bottom: 16};

function chartRange(values, lower, upper) {
  const all = [...values, ...[lower, upper].filter(Number.isFinite)];
  let least = Math.min(...all);
  let most = Math.max(...all);
  if (!(least < most)) {
    least -= 0.5;
    most += 0.5;
  }
  const room = 0.06 * (most - least);
  return [least - room, most + room];
}

// chart: {values, period, lower, upper (bounds, perhaps infinite), held: drawn as a staircase, now: index, end [s]}.
function drawChart(canvas, chart, style) {
  const density = Math.min(window.devicePixelRatio || 1, kMostDensity);
  const box = canvas.getBoundingClientRect();
  const {left, right, top, bottom} = kChartMargin;
  const width = box.width - left - right;
  const height = box.height - top - bottom;
  if (width < 4 || height < 4) return;
  canvas.width = Math.round(box.width * density);
  canvas.height = Math.round(box.height * density);
  const context = canvas.getContext('2d');
  context.setTransform(density, 0, 0, density, 0, 0);
  const [y0, y1] = chartRange(chart.values, chart.lower, chart.upper);
  const toX = (time) => left + time / chart.end * width;
  const toY = (value) => top + (y1 - value) / (y1 - y0) * height;
  context.font = style.small_font;
  context.fillStyle = style.faint;
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const tick of ticks([y0, y1], 3)) {
    context.fillText(formatNumber(tick, 3), left - 6, toY(tick));
    context.globalAlpha = 0.25;
    context.fillRect(left, toY(tick) - 0.5, width, 1);
    context.globalAlpha = 1;
  }
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (const tick of ticks([0, chart.end], 4)) context.fillText(`${formatNumber(tick, 3)} s`, toX(tick), top + height + 4);
  for (const bound of [chart.lower, chart.upper]) {
    if (!Number.isFinite(bound)) continue;
    context.strokeStyle = style.bound;
    context.lineWidth = 1.2;
    context.setLineDash([5, 3]);
    context.beginPath();
    context.moveTo(left, toY(bound));
    context.lineTo(left + width, toY(bound));
    context.stroke();
    context.setLineDash([]);
  }
  context.strokeStyle = style.ink;
  context.lineWidth = 1.6;
  context.beginPath();
  chart.values.forEach((value, k) => {
    if (k === 0) context.moveTo(toX(0), toY(value));
    else context.lineTo(toX(k * chart.period), toY(value));
    if (chart.held) context.lineTo(toX((k + 1) * chart.period), toY(value));
  });
  context.stroke();
  if (chart.now < chart.values.length) {
    context.fillStyle = style.accent;
    context.beginPath();
    context.arc(toX(chart.now * chart.period), toY(chart.values[chart.now]), 4, 0, 2 * Math.PI);
    context.fill();
  }
}
