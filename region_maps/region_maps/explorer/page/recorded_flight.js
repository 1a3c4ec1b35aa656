// The samples of a recorded flight that the page carries: where they lie, and where they leave the map.

const kMostExcursions = 20;

class RecordedFlight {
  constructor(map, block) {
    this.source = block.source;
    this.times = decodeNumbers(block.time);
    this.values = decodeNumbers(block.theta);
    this.p = map.p;
    this.count = this.times.length;
    this.visits = new Int32Array(map.region_count);
    this.excursions = [];
    this.inside = 0;
    let open = null;
    for (let k = 0; k < this.count; ++k) {
      const found = locate(map, this.theta(k));
      if (found.status === 'inside') {
        ++this.visits[found.region];
        ++this.inside;
        open = null;
      } else if (open !== null && open.status === found.status) {
        open.last = k;
      } else {
        open = {first: k, last: k, status: found.status};
        this.excursions.push(open);
      }
    }
  }

  theta(k) {
    return Array.from(this.values.subarray(k * this.p, (k + 1) * this.p));
  }

  describe() {
    const visited = this.visits.reduce((sum, count) => sum + (count > 0 ? 1 : 0), 0);
    const share = this.count > 0 ? formatNumber(100 * this.inside / this.count, 3) : '0';
    return `${this.source}: ${this.count} samples, ${share} % of them in the map. They visit ${visited} of ` +
      `${this.visits.length} regions; ${this.visits.length - visited} were never visited.`;
  }

  excursionTexts() {
    const texts = this.excursions.slice(0, kMostExcursions).map(({first, last, status}) =>
      `${formatNumber(this.times[first])} s to ${formatNumber(this.times[last])} s: ${status}`);
    const more = this.excursions.length - texts.length;
    return more > 0 ? [...texts, `and ${more} more`] : texts;
  }

  // Index of a time's colour in a scale.
  step(k) {
    const span = this.times[this.count - 1] - this.times[0];
    return span > 0 ? Math.round((this.times[k] - this.times[0]) / span * (kScaleSteps - 1)) : 0;
  }
}
