// The closed loop e+ = A e + B (u - U theta) + G w of a map's law with the model of its problem.

// Simulated time, and the number of steps that it may take.
const kFlightTime = 8;
const kFewestSteps = 40;
const kMostSteps = 400;

function multiplyAdd(result, matrix, vector) {
  const columns = vector.length;
  for (let i = 0; i < result.length; ++i) {
    for (let j = 0; j < columns; ++j) result[i] += matrix[i * columns + j] * vector[j];
  }
}

// {thetas, inputs, end}: states, one command less or as many, and why it ended before its time; null: it did not.
function fly(map, model, start, w) {
  const steps = Math.min(kMostSteps, Math.max(kFewestSteps, Math.round(kFlightTime / model.period)));
  const thetas = [start.slice()];
  const inputs = [];
  for (let k = 0; k < steps; ++k) {
    const theta = thetas[k];
    const found = locate(map, theta);
    if (found.status !== 'inside') return {thetas, inputs, end: found.status};
    const u = applyLaw(map, lawOf(map, found.region), theta);
    inputs.push(u);
    thetas.push(nextParameters(model, theta, u, w));
  }
  return {thetas, inputs, end: null};
}

function nextParameters(model, theta, u, w) {
  const error = model.states.map((state) => theta[state.parameter]);
  const next_error = error.map(() => 0);
  const reference = new Array(model.input_count).fill(0);
  multiplyAdd(reference, model.U, theta);
  multiplyAdd(next_error, model.A, error);
  multiplyAdd(next_error, model.B, reference.map((value, j) => u[j] - value));
  multiplyAdd(next_error, model.G, w);
  const next = theta.slice();
  model.states.forEach((state, i) => { next[state.parameter] = next_error[i]; });
  model.previous.forEach(({parameter, input}) => { next[parameter] = u[input]; });
  return next;
}
