// What lies above a slice: samples, state, pointer, flight, and the outline of the region at the pointer.

// Least and greatest x of a polygon.
function endsOf(polygon) {
  const across = polygon.filter((_, i) => i % 2 === 0);
  return [Math.min(...across), Math.max(...across)];
}

// Range of the command on the vertical axis of a map with one parameter.
function commandRange(app) {
  const {map, input} = app;
  const signal = map.inputs[input];
  const values = [];
  for (const {region, polygon} of app.large.cut) {
    for (const end of endsOf(polygon)) values.push(applyLaw(map, lawOf(map, region), [end])[input]);
  }
  return chartRange(values.length > 0 ? values : [0, 1], signal.lower, signal.upper);
}

function sliceLabels(app) {
  const {map, x, y} = app;
  if (y >= 0) return {x: withUnit(map.parameters[x]), y: withUnit(map.parameters[y]), y_range: app.large.y_range};
  return {x: withUnit(map.parameters[x]), y: withUnit(map.inputs[app.input]), y_range: commandRange(app)};
}

// Where a parameter vector lies in a view. Of a map with one parameter, the height is the command.
function placeIn(app, view, theta) {
  if (view.y >= 0) return view.toPixel(theta[view.x], theta[view.y]);
  const {region} = locate(app.map, theta);
  const [lower, upper] = commandRange(app);
  const u = region < 0 ? lower : applyLaw(app.map, lawOf(app.map, region), theta)[app.input];
  return view.toPixel(theta[view.x], (u - lower) / (upper - lower));
}

function drawOverlay(app, view, region) {
  const {style, map} = app;
  const large = view === app.large;
  const context = view.begin();
  if (large) view.drawAxes(context, sliceLabels(app), style);
  view.clipToPlot(context);
  if (view.y < 0) drawCommandLine(app, context, view);
  context.strokeStyle = style.ink;
  context.lineWidth = large ? 2.2 : 1.4;
  for (const {region: shown, polygon} of view.cut) {
    if (shown !== region) continue;
    const path = new Path2D();
    view.addPolygon(path, polygon);
    context.stroke(path);
  }
  drawFlight(app, context, view, large);
  if (app.hover || !large) view.drawCross(context, placeIn(app, view, app.hover || app.theta), style);
  view.drawDot(context, placeIn(app, view, app.theta), large ? 7 : 3.5, style.accent, style);
  context.restore();
  view.canvas.dataset.chosen = !large && map.p > 2 && view.x === Math.min(app.x, app.y) &&
    view.y === Math.max(app.x, app.y) ? 'yes' : '';
}

function drawFlight(app, context, view, large) {
  const {flight, now} = app.loop;
  if (flight === null) return;
  view.drawLine(context, flight.thetas.map((theta) => placeIn(app, view, theta)), large ? 2 : 1.2, app.style);
  if (now > 0 && now < flight.thetas.length) {
    view.drawDot(context, placeIn(app, view, flight.thetas[now]), large ? 5 : 3, app.style.ink, app.style);
  }
}

function drawCommandLine(app, context, view) {
  for (const {polygon} of view.cut) view.drawLine(context, endsOf(polygon).map((x) => placeIn(app, view, [x])), 2, app.style);
}

// On the base of a view: samples move with the slice only, so hovering need not draw them again.
function drawSamples(app, view) {
  const {flight, time_scale} = app;
  const size = view === app.large ? 2.4 : 1.2;
  const context = view.base.getContext('2d');
  view.clipToPlot(context);
  for (let k = 0; k < flight.count; ++k) {
    const base = k * flight.p;
    const [x, y] = view.y < 0 ? placeIn(app, view, [flight.values[base]])
      : view.toPixel(flight.values[base + view.x], flight.values[base + view.y]);
    context.fillStyle = cssOf(time_scale[flight.step(k)]);
    context.fillRect(x - size / 2, y - size / 2, size, size);
  }
  context.restore();
}
