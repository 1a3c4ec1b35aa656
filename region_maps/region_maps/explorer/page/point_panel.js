// What holds at one parameter vector: region, command, law, active constraints, next facet, depth, cost.

// Beyond this step past a facet [scaled], the region behind it is asked for.
const kBehindFacet = 1e-6;
// Terms of a law below this share of its greatest are rounding, and are not written.
const kLawRounding = 1e-9;

function lawText(map, law, input) {
  const row = (law * map.m + input) * (map.p + 1);
  const half = (i) => (i < map.p ? 0.5 * (map.parameters[i].upper - map.parameters[i].lower) : 1);
  let greatest = 0;
  for (let i = 0; i <= map.p; ++i) greatest = Math.max(greatest, Math.abs(map.laws[row + i]) * half(i));
  let text = '';
  const add = (i, name) => {
    const value = map.laws[row + i];
    if (Math.abs(value) * half(i) <= kLawRounding * greatest) return;
    const size = formatNumber(Math.abs(value), 3) + (name === '' ? '' : `\u00b7${name}`);
    if (text === '') text = (value < 0 ? '\u2212' : '') + size;
    else text += (value < 0 ? ' \u2212 ' : ' + ') + size;
  };
  for (let i = 0; i < map.p; ++i) add(i, map.parameters[i].name);
  add(map.p, '');
  return text === '' ? '0' : text;
}

// The region on the other side of a facet that theta is near to; -1 where the map ends.
function regionBehind(map, {row, distance}, theta) {
  const base = (Math.abs(row) - 1) * (map.p + 1);
  const sign = row > 0 ? 1 : -1;
  const point = theta.map((value, i) => {
    const half = 0.5 * (map.parameters[i].upper - map.parameters[i].lower);
    return value + sign * (distance + kBehindFacet) * map.planes[base + i] * half * half;
  });
  return locate(map, point).region;
}

function constraintNames(app, region) {
  const {map, facts} = app;
  if (map.reduced) return ['a reduced map does not tell them'];
  const active = Array.from(activeOf(map, region));
  if (active.length === 0) return ['none'];
  return active.map((row) => facts.constraints[row] || `row ${row}`);
}

// [term, text or list of texts] of everything known at theta.
function pointFacts(app, theta) {
  const {map, cost, facts} = app;
  const found = locate(map, theta);
  const rows = [];
  if (found.region < 0) {
    rows.push(['state', found.status], ['command', 'the map has no answer here']);
    return {title: 'Outside the map', rows, found};
  }
  const law = lawOf(map, found.region);
  const u = applyLaw(map, law, theta);
  map.inputs.forEach((signal, j) => {
    const at = signal.upper - u[j] <= map.tolerance ? ', at its upper bound'
      : u[j] - signal.lower <= map.tolerance ? ', at its lower bound' : '';
    rows.push([`command ${signal.name}`, `${formatNumber(u[j])} ${signal.unit}${at}`]);
    rows.push([`law ${law} (of ${map.law_count}, counted from 0)`, `${signal.name} = ${lawText(map, law, j)}`]);
  });
  rows.push(['active constraints', constraintNames(app, found.region)]);
  const facet = nearestFacet(map, found.region, theta);
  if (facet !== null) {
    const behind = regionBehind(map, facet, theta);
    rows.push(['next facet', `${formatNumber(100 * Math.max(0, facet.distance), 3)} % of half the ranges away, ` +
      (behind < 0 ? 'the edge of the map' : `region ${behind} behind it`)]);
  }
  rows.push(['search tree', `${found.depth} of at most ${map.depth} nodes`]);
  if (cost) {
    const value = cost.at(found.region, theta);
    rows.push(['cost', value === null ? 'the active set does not tell it' : formatNumber(value, 5)]);
  } else {
    rows.push(['cost', facts.no_cost]);
  }
  return {title: `Region ${found.region}`, rows, found, u};
}

function showPoint(app, theta) {
  const facts = pointFacts(app, theta);
  byId('point-title').textContent = facts.title;
  const entries = [];
  for (const [term, value] of facts.rows) {
    entries.push(element('dt', term));
    const description = element('dd', Array.isArray(value) ? '' : value);
    if (Array.isArray(value)) {
      const list = element('ul');
      list.append(...value.map((name) => element('li', name)));
      description.append(list);
    }
    entries.push(description);
  }
  byId('point').replaceChildren(...entries);
  return facts;
}
