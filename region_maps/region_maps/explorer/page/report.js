// #report in the address: the page writes what it computed as JSON, for its test.

// The states that a drag to a quarter of the slice from the left and from below, and then an arrow key, lead to.
function moveState(app) {
  const {canvas, plot} = app.large;
  const start = app.theta;
  const box = canvas.getBoundingClientRect();
  canvas.dispatchEvent(new PointerEvent('pointermove', {
    buttons: 1, clientX: box.left + plot.left + 0.25 * plot.width, clientY: box.top + plot.top + 0.75 * plot.height}));
  const dragged = {theta: app.theta};
  app.drawAll();
  dragged.flight = app.loop.flight;
  canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}));
  const pressed = {theta: app.theta};
  app.setTheta(start);
  app.drawAll();
  return {dragged, pressed};
}

function writeReport(app) {
  const {map, flight} = app;
  const answers = [];
  for (let k = 0; flight && k < flight.count; ++k) {
    const theta = flight.theta(k);
    const facts = showPoint(app, theta);
    answers.push({title: byId('point-title').textContent, status: facts.found.status, region: facts.found.region,
                  shown: (facts.rows.find(([term]) => term.startsWith('command')) || ['', ''])[1], u: facts.u || [],
                  cost: app.cost && facts.u ? app.cost.at(facts.found.region, theta) : null});
  }
  showPoint(app, app.theta);
  const report = {
    x: app.x, y: app.y, theta: app.theta, answers,
    slice: app.large.cut.map(({region, polygon}) => ({region, polygon})),
    text: byId('point').innerText || byId('point').textContent, title: document.title,
    elements: document.body.getElementsByTagName('*').length,
    flight: app.loop.flight,
    moved: moveState(app), visited: flight ? Array.from(flight.visits) : [], excursions: flight ? flight.excursions : [],
  };
  document.body.append(element('pre', JSON.stringify(report), {id: 'report'}));
}
