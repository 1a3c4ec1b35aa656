// The choices of `colour`, and how each paints a slice.

const kLegendHue = 210;

class Colouring {
  constructor(map, cost, flight) {
    this.map = map;
    this.cost = cost;
    this.flight = flight;
    this.sets = numberActiveSets(map);
    this.setTheme('light');
  }

  setTheme(theme) {
    const scale = kScales[theme];
    this.theme = theme;
    this.missing = packColour(parseColour(scale.missing));
    this.diverging = scaleTable(scale.diverging);
    this.sequential = scaleTable(scale.sequential);
  }

  choices() {
    const result = [['command', 'command'], ['active', 'active set'], ['depth', 'depth in the search tree']];
    if (this.cost) result.splice(1, 0, ['cost', 'cost']);
    if (this.flight) result.push(['visits', 'samples of the flight']);
    return result;
  }

  // {fill(painter), legend}: `cut` is the slice of `planes` through theta.
  paint(choice, input, planes, cut, x, y, theta) {
    switch (choice) {
      case 'cost': return this.paintCost(cut, x, y, theta);
      case 'active': return this.paintSets(cut);
      case 'depth': return this.paintDepth(planes);
      case 'visits': return this.paintVisits(cut);
      default: return this.paintCommand(input, cut, x, y, theta);
    }
  }

  paintCommand(input, cut, x, y, theta) {
    const {map} = this;
    const signal = map.inputs[input];
    const coefficients = cut.map(({region}) => restrictAffine(
      map.laws, (lawOf(map, region) * map.m + input) * (map.p + 1), map.p, x, y, theta));
    const bounded = Number.isFinite(signal.lower) && Number.isFinite(signal.upper) && signal.lower < signal.upper;
    const [lower, upper] = aroundZero(bounded ? [signal.lower, signal.upper] : rangeAtCorners(cut, coefficients));
    const scale = {table: this.diverging, lower, upper, bent: false};
    return this.paintFunction(cut, coefficients, scale, withUnit(signal));
  }

  paintCost(cut, x, y, theta) {
    const coefficients = cut.map(({region}) => {
      const matrix = this.cost.of(region);
      return matrix === null ? null : restrictQuadratic(matrix, this.map.p, x, y, theta);
    });
    const [lower, upper] = rangeAtCorners(cut, coefficients);
    const scale = {table: this.sequential, lower: Math.min(lower, 0), upper, bent: true};
    return this.paintFunction(cut, coefficients, scale, 'cost, on a square-root scale');
  }

  paintFunction(cut, coefficients, scale, text) {
    const fill = (painter) => cut.forEach(({polygon}, k) => {
      if (coefficients[k] === null) painter.fillFlat(polygon, this.missing);
      else painter.fillQuadratic(polygon, coefficients[k], scale);
    });
    return {fill, legend: {table: scale.table, lower: formatNumber(scale.lower, 3),
                           upper: formatNumber(scale.upper, 3), text}};
  }

  // The hue tells sets apart, lightness counts their constraints.
  setColour(hue, share) {
    const lightness = this.theme === 'dark' ? 0.16 + 0.4 * share : 0.95 - 0.45 * share;
    return hueColour(hue, lightness, share > 0 ? 0.2 + 0.15 * share : 0);
  }

  paintSets(cut) {
    const fill = (painter) => cut.forEach(({region, polygon}) => painter.fillFlat(polygon, this.setColour(
      this.sets.of_region[region] * kGoldenAngle, activeOf(this.map, region).length / Math.max(1, this.sets.most))));
    const table = new Uint32Array(kScaleSteps);
    for (let i = 0; i < kScaleSteps; ++i) table[i] = this.setColour(kLegendHue, i / (kScaleSteps - 1));
    return {fill, legend: {table, lower: '0', upper: String(this.sets.most),
                           text: `active constraints; hue: one of ${this.sets.count} active sets`}};
  }

  paintDepth(planes) {
    const cells = cutTree(planes);
    const least = cells.reduce((sum, {depth}) => Math.min(sum, depth), Infinity);
    const most = cells.reduce((sum, {depth}) => Math.max(sum, depth), least);
    const colour = (depth) => this.sequential[Math.round((depth - least) / Math.max(1, most - least) * (kScaleSteps - 1))];
    const fill = (painter) => cells.forEach(({depth, polygon}) => painter.fillFlat(polygon, colour(depth)));
    return {fill, legend: {table: this.sequential, lower: String(least), upper: String(most),
                           text: 'nodes on the path to the leaf'}};
  }

  paintVisits(cut) {
    const {visits} = this.flight;
    const most = visits.reduce((sum, count) => Math.max(sum, count), 1);
    const colour = (count) => (count === 0 ? this.missing
      : this.sequential[Math.round((0.25 + 0.75 * Math.log(count) / Math.log(most + 1)) * (kScaleSteps - 1))]);
    const fill = (painter) => cut.forEach(({region, polygon}) => painter.fillFlat(polygon, colour(visits[region])));
    return {fill, legend: {table: this.sequential.slice(kScaleSteps / 4), lower: '1', upper: String(most),
                           text: 'samples in the region, logarithmic; grey: never visited'}};
  }
}
