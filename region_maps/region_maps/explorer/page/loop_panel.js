// The flight from the state: its text, its charts, and its marker in all slices.

class LoopPanel {
  constructor(app) {
    this.app = app;
    this.charts = [];
    this.now = 0;
    this.flight = null;
    this.w = [];
    const {model} = app.facts;
    if (!model) {
      byId('loop-text').textContent = app.facts.no_model;
      byId('loop-controls').hidden = true;
      return;
    }
    const {inputs} = app.map;
    for (let j = 0; j < model.input_count; ++j) this.addChart(withUnit(inputs[j]));
    model.states.forEach((state) => this.addChart(withUnit(app.map.parameters[state.parameter])));
    model.disturbances.forEach((signal, k) => this.addDisturbance(signal, k));
    byId('time').addEventListener('input', () => this.setNow(Number(byId('time').value)));
    byId('play').addEventListener('click', () => this.play());
  }

  addChart(title) {
    const canvas = element('canvas', '', {role: 'img', 'aria-label': `${title} over time`});
    const figure = element('figure');
    figure.append(element('figcaption', title), canvas);
    byId('charts').append(figure);
    this.charts.push(canvas);
  }

  addDisturbance(signal, k) {
    const start = Math.max(signal.lower, Math.min(signal.upper, 0));
    this.w.push(start);
    const output = element('output', `${formatNumber(start)} ${signal.unit}`);
    const range = element('input', '', {type: 'range', min: signal.lower, max: signal.upper, step: 'any',
                                        'aria-label': signal.name});
    range.value = start;
    range.addEventListener('input', () => {
      this.w[k] = Number(range.value);
      output.textContent = `${formatNumber(this.w[k])} ${signal.unit}`;
      this.app.loopChanged();
    });
    const label = element('label', `constant disturbance ${signal.name}`);
    label.append(range, output);
    byId('disturbances').append(label);
  }

  update(theta) {
    const {map, facts} = this.app;
    if (!facts.model) return;
    this.flight = fly(map, facts.model, theta, this.w);
    const last = Math.max(0, this.flight.inputs.length - 1);
    byId('time').max = last;
    this.now = Math.min(this.now, last);
    byId('time').value = this.now;
    this.showTime();
    const time = formatNumber(this.flight.inputs.length * facts.model.period);
    byId('loop-text').textContent = this.flight.end === null
      ? `The law and the model of the problem, for ${time} s. Dashed: bounds of the command and of the map.`
      : this.flight.inputs.length === 0 ? `This state is ${this.flight.end}, so there is no command.`
        : `After ${time} s the state is ${this.flight.end}; the flight ends there.`;
  }

  showTime() {
    byId('time-text').textContent = `${formatNumber(this.now * this.app.facts.model.period, 3)} s`;
  }

  setNow(now) {
    this.now = now;
    byId('time').value = now;
    this.showTime();
    this.app.requestOverlays();
  }

  play() {
    const {period} = this.app.facts.model;
    const begin = performance.now();
    const run = (this.run || 0) + 1;
    this.run = run;
    const step = (time) => {
      const k = Math.max(0, Math.floor((time - begin) / 1000 / period));
      const last = this.flight.inputs.length - 1;
      if (this.run !== run || last < 0) return;
      this.setNow(Math.min(k, last));
      if (k < last) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  drawCharts(style) {
    const {flight} = this;
    if (flight === null || flight.inputs.length === 0) return;
    const {map, facts: {model}} = this.app;
    const steps = flight.inputs.length;
    const common = {period: model.period, now: this.now, end: steps * model.period};
    this.charts.forEach((canvas, i) => {
      const held = i < model.input_count;
      const parameter = held ? 0 : model.states[i - model.input_count].parameter;
      const signal = held ? map.inputs[i] : map.parameters[parameter];
      const values = held ? flight.inputs.map((u) => u[i]) : flight.thetas.map((theta) => theta[parameter]);
      drawChart(canvas, Object.assign({held, values, lower: signal.lower, upper: signal.upper}, common), style);
    });
  }
}
