// The page: state, controls, and what is drawn when.

// Milliseconds of drawing small slices before the browser gets a turn.
const kFrameBudget = 10;
// Steps of the arrow keys, as shares of a range.
const kKeyStep = 0.01;
const kLongKeyStep = 0.1;

class App {
  constructor(map, facts) {
    this.map = map;
    this.facts = facts;
    this.planes = new SlicePlanes(map);
    this.flight = facts.flight ? new RecordedFlight(map, facts.flight) : null;
    this.cost = facts.program && !map.reduced ? new CostFunction(map, facts.program) : null;
    this.colouring = new Colouring(map, this.cost, this.flight);
    this.start = map.parameters.map(({lower, upper}) => (lower <= 0 && upper >= 0 ? 0 : 0.5 * (lower + upper)));
    if (facts.model) this.start = this.stateToFly();
    this.theta = this.start.slice();
    this.x = 0;
    this.y = map.p > 1 ? 1 : -1;
    this.colour = 'command';
    this.input = 0;
    this.hover = null;
    this.cells = [];
    this.large = new SliceView(byId('slice'), kMargin);
  }

  // A state away from the reference, so that there is something to fly: a share of each error's range.
  stateToFly() {
    const theta = this.start.slice();
    const share = 0.3;
    this.facts.model.states.forEach(({parameter}, i) => {
      const {lower, upper} = this.map.parameters[parameter];
      if (i === 0) theta[parameter] += share * (upper - lower);
    });
    return locate(this.map, theta).region >= 0 ? theta : this.start;
  }

  bounded(theta) {
    return theta.map((value, i) => Math.max(this.map.parameters[i].lower, Math.min(this.map.parameters[i].upper, value)));
  }

  open() {
    const {map} = this;
    document.title = `${map.name}: region map`;
    byId('title').textContent = map.name;
    byId('summary').textContent = [[map.region_count, 'region'], [map.law_count, 'law'], [map.p, 'parameter'],
      [map.m, 'input']].map(([count, noun]) => `${count} ${noun}${count === 1 ? '' : 's'}`).join(', ') +
      `; ${map.status}${map.reduced ? '; reduced' : ''}`;
    byId('line-hint').textContent = map.p === 1 ? 'The line is the command.'
      : this.facts.model ? 'The line is the flight, projected onto the slice.' : '';
    this.loop = new LoopPanel(this);
    const report = readAddress(this);
    this.buildControls();
    this.buildFlight();
    this.buildMatrix();
    this.watch();
    this.applyTheme();
    this.drawAll();
    if (report) writeReport(this);
  }

  buildControls() {
    const {map} = this;
    const names = map.parameters.map((signal, i) => [i, signal.name]);
    fillSelect(byId('x-axis'), names);
    fillSelect(byId('y-axis'), map.p > 1 ? names : [[-1, 'command']]);
    fillSelect(byId('colour'), this.colouring.choices());
    fillSelect(byId('input'), map.inputs.map((signal, j) => [j, signal.name]));
    byId('input-choice').hidden = map.m < 2;
    byId('x-axis').addEventListener('change', () => this.setPair(Number(byId('x-axis').value), this.y));
    byId('y-axis').addEventListener('change', () => this.setPair(this.x, Number(byId('y-axis').value)));
    byId('colour').addEventListener('change', () => { this.colour = byId('colour').value; this.changed(); });
    byId('input').addEventListener('change', () => { this.input = Number(byId('input').value); this.changed(); });
    byId('theme').addEventListener('change', () => { this.applyTheme(); this.changed(); });
    byId('reset').addEventListener('click', () => this.setTheta(this.start.slice()));
    byId('save-png').addEventListener('click', () => this.large.canvas.toBlob((blob) => saveFile(`${map.name}.png`, blob)));
    this.sliders = map.parameters.map((signal, i) => this.addSlider(signal, i));
  }

  addSlider(signal, i) {
    const attributes = {min: signal.lower, max: signal.upper, step: 'any', 'aria-label': signal.name};
    const range = element('input', '', Object.assign({type: 'range'}, attributes));
    const number = element('input', '', Object.assign({type: 'number'}, attributes));
    const change = (value) => {
      if (!Number.isFinite(value)) return;
      const theta = this.theta.slice();
      theta[i] = value;
      this.setTheta(this.bounded(theta));
    };
    range.addEventListener('input', () => change(Number(range.value)));
    number.addEventListener('change', () => change(number.valueAsNumber));
    const row = element('div', '', {class: 'slider'});
    row.append(element('span', signal.name, {class: 'name'}), range, number, element('span', signal.unit, {class: 'unit'}));
    byId('sliders').append(row);
    return {range, number, row};
  }

  buildFlight() {
    if (!this.flight) return;
    byId('flight-panel').hidden = false;
    byId('flight-text').textContent = this.flight.describe();
    byId('excursions').append(...this.flight.excursionTexts().map((text) => element('li', text)));
    const {times, count} = this.flight;
    byId('flight-start').textContent = count > 0 ? `${formatNumber(times[0])} s` : '';
    byId('flight-end').textContent = count > 0 ? `${formatNumber(times[count - 1])} s` : '';
    byId('show-flight').addEventListener('change', () => this.requestDraw());
  }

  // One small slice for each pair: the lower parameter's row, the other's column.
  buildMatrix() {
    const {p, parameters} = this.map;
    const matrix = byId('matrix');
    byId('matrix-panel').hidden = p < 3;
    if (p < 3) return;
    matrix.style.gridTemplateColumns = `1.6rem repeat(${p - 1}, minmax(0, 1fr))`;
    for (let y = 1; y < p; ++y) {
      matrix.append(element('span', parameters[y].name, {class: 'row-name'}));
      for (let x = 0; x < p - 1; ++x) {
        if (x >= y) {
          matrix.append(element('span'));
          continue;
        }
        const label = `${parameters[x].name} and ${parameters[y].name}`;
        const canvas = element('canvas', '', {tabindex: 0, role: 'button', 'aria-label': label, title: label});
        const view = new SliceView(canvas);
        [view.x, view.y] = [x, y];
        const choose = () => this.setPair(x, y);
        canvas.addEventListener('click', choose);
        canvas.addEventListener('keydown', (event) => { if (event.key === 'Enter') choose(); });
        this.watchPointer(view, false);
        matrix.append(canvas);
        this.cells.push(view);
      }
    }
    matrix.append(element('span'));
    for (let x = 0; x < p - 1; ++x) matrix.append(element('span', parameters[x].name, {class: 'column-name'}));
  }

  watch() {
    this.watchPointer(this.large, true);
    byId('slice').addEventListener('keydown', (event) => this.pressKey(event));
    window.addEventListener('resize', () => { this.forget(); this.requestDraw(); });
    window.addEventListener('hashchange', () => { readAddress(this); this.applyTheme(); this.changed(); });
    for (const query of ['(prefers-color-scheme: dark)', '(prefers-contrast: more)']) {
      const media = window.matchMedia(query);
      if (media.addEventListener) media.addEventListener('change', () => { this.applyTheme(); this.changed(); });
    }
  }

  // Hovering shows the point in all slices; in the large slice, a press or drag sets the state.
  watchPointer(view, sets) {
    const point = (event) => {
      const [x, y] = view.fromPointer(event);
      const theta = this.theta.slice();
      theta[view.x] = x;
      if (view.y >= 0) theta[view.y] = y;
      return theta;
    };
    view.canvas.addEventListener('pointermove', (event) => {
      if (!view.x_range) return;
      if (sets && event.buttons === 1) this.setTheta(point(event));
      else this.setHover(point(event));
    });
    view.canvas.addEventListener('pointerleave', () => this.setHover(null));
    if (!sets) return;
    view.canvas.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      view.canvas.setPointerCapture(event.pointerId);
      this.setTheta(point(event));
    });
  }

  pressKey(event) {
    const steps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
    if (!steps) return;
    event.preventDefault();
    const size = event.shiftKey ? kLongKeyStep : kKeyStep;
    const theta = this.theta.slice();
    [this.x, this.y].forEach((i, axis) => {
      if (i < 0) return;
      const {lower, upper} = this.map.parameters[i];
      theta[i] += steps[axis] * size * (upper - lower);
    });
    this.setTheta(this.bounded(theta));
  }

  setPair(x, y) {
    if (x === y) [x, y] = [this.y, this.x];
    [this.x, this.y] = [x, y];
    this.changed();
  }

  setTheta(theta) {
    this.theta = theta;
    this.hover = null;
    this.changed();
  }

  setHover(theta) {
    this.hover = theta;
    this.requestOverlays();
  }

  changed() {
    this.requestDraw();
    clearTimeout(this.address_timer);
    this.address_timer = setTimeout(() => writeAddress(this), 250);
  }

  loopChanged() {
    this.loop.update(this.theta);
    this.requestOverlays();
  }

  applyTheme() {
    const chosen = byId('theme').value;
    const wants = (query) => window.matchMedia(query).matches;
    const theme = chosen || (wants('(prefers-contrast: more)') ? 'contrast'
      : wants('(prefers-color-scheme: dark)') ? 'dark' : 'light');
    document.documentElement.dataset.theme = theme;
    this.colouring.setTheme(theme);
    const css = getComputedStyle(document.documentElement);
    const colour = (name) => css.getPropertyValue(`--${name}`).trim();
    const family = getComputedStyle(document.body).fontFamily;
    this.style = {ink: colour('ink'), faint: colour('faint'), surface: colour('surface'), accent: colour('accent'),
                  bound: colour('bound'), outline: theme === 'contrast' ? 1 : kOutlineOpacity,
                  font: `12px ${family}`, small_font: `11px ${family}`};
    this.time_scale = scaleTable(theme === 'dark' ? ['#5b3fa8', '#c2408f', '#ff9b54', '#ffe98a']
      : ['#2b1b5e', '#8c2a84', '#dc5a4b', '#f5c242']);
    this.forget();
  }

  forget() {
    for (const view of [this.large, ...this.cells]) view.key = '';
  }

  requestDraw() {
    this.stale = true;
    this.requestOverlays();
  }

  requestOverlays() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      if (this.stale) this.drawAll(kFrameBudget);
      else this.drawOverlays();
    });
  }

  // What a slice shows: drawn again only where it is another.
  keyOf(view) {
    const fixed = this.theta.map((value, i) => (i === view.x || i === view.y ? '' : value)).join();
    return [view.x, view.y, this.colour, this.input, this.showsFlight(), fixed].join('|');
  }

  showsFlight() {
    return this.flight !== null && byId('show-flight').checked;
  }

  drawSlice(view, theta) {
    if (view.key === '' && !view.resize()) return null;
    const cut = cutMap(this.planes, view.x, view.y, theta);
    const paint = this.colouring.paint(this.colour, this.input, this.planes, cut, view.x, view.y, theta);
    view.drawBase(this.planes, cut, paint.fill, this.style);
    if (this.showsFlight()) drawSamples(this, view);
    return paint.legend;
  }

  drawLarge(theta) {
    [this.large.x, this.large.y] = [this.x, this.y];
    return this.drawSlice(this.large, theta);
  }

  // Draws what is stale; small slices only as long as the budget [ms] allows, and the rest in later frames.
  drawAll(budget = Infinity) {
    this.stale = false;
    this.showControls();
    this.loop.update(this.theta);
    [this.large.x, this.large.y] = [this.x, this.y];
    if (this.large.key !== this.keyOf(this.large)) {
      const legend = this.drawLarge(this.theta);
      if (legend !== null) this.showLegend(legend);
      this.large.key = this.keyOf(this.large);
    }
    const begin = performance.now();
    for (const view of this.cells) {
      const key = this.keyOf(view);
      if (view.key === key) continue;
      if (performance.now() - begin > budget) {
        this.requestDraw();
        break;
      }
      this.drawSlice(view, this.theta);
      view.key = key;
    }
    this.drawOverlays();
  }

  showControls() {
    byId('x-axis').value = this.x;
    byId('y-axis').value = this.y;
    byId('colour').value = this.colour;
    byId('input').value = this.input;
    this.sliders.forEach(({range, number, row}, i) => {
      range.value = this.theta[i];
      if (document.activeElement !== number) number.value = Number(this.theta[i].toPrecision(5));
      row.dataset.axis = i === this.x ? 'across' : i === this.y ? 'up' : '';
    });
  }

  drawScale(canvas, table) {
    canvas.width = table.length;
    canvas.height = 1;
    const image = new ImageData(table.length, 1);
    new Uint32Array(image.data.buffer).set(table);
    canvas.getContext('2d').putImageData(image, 0, 0);
  }

  showLegend(legend) {
    this.drawScale(byId('legend'), legend.table);
    byId('legend-lower').textContent = legend.lower;
    byId('legend-upper').textContent = legend.upper;
    byId('legend-text').textContent = legend.text;
    if (this.flight) this.drawScale(byId('flight-legend'), this.time_scale);
  }

  drawOverlays() {
    const facts = showPoint(this, this.hover || this.theta);
    for (const view of [this.large, ...this.cells]) if (view.x_range) drawOverlay(this, view, facts.found.region);
    this.loop.drawCharts(this.style);
  }
}

new App(readMap(decodeBase64(byId('map').textContent)), JSON.parse(byId('facts').textContent)).open();
