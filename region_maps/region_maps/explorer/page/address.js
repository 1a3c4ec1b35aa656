// The view in the fragment of the address: a link shows the same slice again.

function writeAddress(app) {
  const name = (i) => encodeURIComponent(app.map.parameters[i].name);
  const parts = [`x=${name(app.x)}`];
  if (app.y >= 0) parts.push(`y=${name(app.y)}`);
  parts.push(`colour=${app.colour}`, `input=${app.input}`, `at=${app.theta.map((value) => Number(value.toPrecision(6))).join()}`);
  if (byId('theme').value !== '') parts.push(`theme=${byId('theme').value}`);
  try {
    history.replaceState(null, '', `#${parts.join('&')}`);
  } catch (error) {
    // A browser may limit how often the address changes; the view itself does not depend on it.
  }
}

function decodePart(text) {
  try {
    return decodeURIComponent(text);
  } catch (error) {
    return '';
  }
}

// Takes what the fragment holds and the map allows; the rest stays as it is.
function readAddress(app) {
  const values = new Map(location.hash.slice(1).split('&').map((part) => {
    const [key, ...rest] = part.split('=');
    return [key, decodePart(rest.join('='))];
  }));
  const {map} = app;
  const index = (name) => map.parameters.findIndex((signal) => signal.name === name);
  const x = index(values.get('x'));
  const y = index(values.get('y'));
  if (x >= 0 && y >= 0 && x !== y) [app.x, app.y] = [x, y];
  if (app.colouring.choices().some(([choice]) => choice === values.get('colour'))) app.colour = values.get('colour');
  const input = Number(values.get('input') || 0);
  if (Number.isInteger(input) && input >= 0 && input < map.m) app.input = input;
  const at = (values.get('at') || '').split(',').map((text) => (text === '' ? NaN : Number(text)));
  if (at.length === map.p && at.every(Number.isFinite)) app.theta = app.bounded(at);
  if (['light', 'dark', 'contrast'].includes(values.get('theme'))) byId('theme').value = values.get('theme');
  return values.has('report');
}
