// The large slice as SVG and PNG.

function escapeXml(text) {
  return text.replace(/[&<>"]/g, (mark) => ({'&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;'}[mark]))
    .replace(/[\u0000-\u001f]/g, ' ');
}

// Colours as an embedded picture; outlines, axes and the flight as lines.
function sliceSvg(view, labels, flight, state, style) {
  const {plot, width, height, density} = view;
  const colours = element('canvas');
  colours.width = Math.round(plot.width * density);
  colours.height = Math.round(plot.height * density);
  colours.getContext('2d').drawImage(view.base, -Math.round(plot.left * density), -Math.round(plot.top * density));
  const number = (value) => value.toFixed(2);
  const path = (points) => points.map(([x, y], i) => `${i === 0 ? 'M' : 'L'}${number(x)} ${number(y)}`).join('');
  const outlines = view.cut.map(({polygon}) => {
    const corners = [];
    for (let i = 0; i < polygon.length; i += 2) corners.push(view.toPixel(polygon[i], polygon[i + 1]));
    return `${path(corners)}Z`;
  }).join('');
  const bottom = plot.top + plot.height;
  const text = (x, y, content, attributes) =>
    `<text x="${number(x)}" y="${number(y)}" ${attributes}>${escapeXml(content)}</text>`;
  const [y0, y1] = labels.y_range;
  const parts = [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" ` +
      'font-family="sans-serif" font-size="12">',
    `<rect width="${width}" height="${height}" fill="${style.surface}"/>`,
    `<image x="${plot.left}" y="${plot.top}" width="${plot.width}" height="${plot.height}" ` +
      `preserveAspectRatio="none" href="${colours.toDataURL('image/png')}"/>`,
    `<clipPath id="plot"><rect x="${plot.left}" y="${plot.top}" width="${plot.width}" height="${plot.height}"/></clipPath>`,
    `<path d="${outlines}" fill="none" stroke="${style.ink}" stroke-opacity="${style.outline}" stroke-width="0.8"/>`,
    `<rect x="${plot.left}" y="${plot.top}" width="${plot.width}" height="${plot.height}" fill="none" stroke="${style.ink}"/>`,
    `<g clip-path="url(#plot)"><path d="${path(flight)}" fill="none" stroke="${style.surface}" stroke-width="4"/>`,
    `<path d="${path(flight)}" fill="none" stroke="${style.ink}" stroke-width="2"/>`,
    `<circle cx="${number(state[0])}" cy="${number(state[1])}" r="6" fill="${style.accent}" stroke="${style.surface}" ` +
      'stroke-width="1.5"/></g>',
    `<g fill="${style.ink}" text-anchor="middle">`,
    ...ticks(view.x_range, 6).map((tick) =>
      text(view.toPixel(tick, view.y_range[0])[0], bottom + 17, formatNumber(tick), '')),
    text(plot.left + plot.width / 2, bottom + 36, labels.x, ''),
    text(16, plot.top + plot.height / 2, labels.y, `transform="rotate(-90 16 ${number(plot.top + plot.height / 2)})"`),
    ...ticks(labels.y_range, 6).map((tick) =>
      text(plot.left - 8, plot.top + (y1 - tick) / (y1 - y0) * plot.height + 4, formatNumber(tick), 'text-anchor="end"')),
    '</g></svg>',
  ];
  return parts.join('\n');
}
