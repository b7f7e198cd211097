// Back onto constraints by the least change in the metric of the mass matrix, as `mbs_runtime::Projector` finds it.
// Rows that depend on others are left out.
//
// Source: E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed. 2006, IV.4; G. H. Golub,
// C. F. Van Loan, Matrix Computations, 4th ed. 2013, 4.2.1, 5.2.8, 5.4.2.

const ROOT = Math.sqrt(Number.EPSILON);
const MOST_ITERATIONS = 100;
const MOST_HALVINGS = 10;

const product = (a, b, n = a.length) => {
  let sum = 0;
  for (let i = 0; i < n; i++) sum = sum + a[i] * b[i];
  return sum;
};
const greatest = (values, least = 0) => values.reduce((size, x) => (size > Math.abs(x) ? size : Math.abs(x)), least);
const allFinite = (values) => values.every((x) => Math.abs(x) < Infinity);

/** The exponent of a double; of zero and of subnormal ones that of the smallest normal one. */
const bits = new DataView(new ArrayBuffer(8));
function exponent(x) {
  bits.setFloat64(0, x);
  return Math.max(((bits.getUint32(0) >>> 20) & 0x7ff) - 1023, -1022);
}

/** The largest entry of a row, scaled; of one that only coordinates without a scale know, unscaled. */
function extent(row, scales) {
  const scaled = greatest(row.map((a, i) => a * scales[i]));
  return scaled === 0 ? greatest(row) : scaled;
}

/** Scales to inertias of about one; coordinates without inertia are scaled to the rows. */
function scalesOf(mass, rows) {
  const scales = mass.map((row, i) => {
    const inertia = row[i];
    const has = Math.abs(inertia) > 0 && Math.abs(inertia) < Infinity;
    return has ? 2 ** -Math.floor(exponent(inertia) / 2) : 0;
  });
  const without = mass.map((row, i) => i).filter((i) => mass[i][i] === 0);
  const found = without.map((i) => {
    const share = (row) => {
      const size = extent(row, scales);
      return size === 0 ? 0 : Math.abs(row[i]) / size;
    };
    const largest = greatest(rows.map(share));
    return largest > 0 && largest < Infinity ? 2 ** -exponent(largest) : 1;
  });
  without.forEach((i, k) => (scales[i] = found[k]));
  return scales;
}

/** `M + AᵀA = L Lᵀ` of the scaled system, or null. */
function factorized(mass, rows, scales) {
  const n = mass.length;
  const m = mass.map((row, i) => row.map((x, j) => x * scales[i] * scales[j]));
  for (const a of rows) {
    const size = extent(a, scales);
    if (!(size > 0 && size < Infinity)) continue;
    for (let i = 0; i < n; i++) {
      const own = (a[i] * scales[i]) / size;
      for (let j = 0; j <= i; j++) m[i][j] = m[i][j] + own * ((a[j] * scales[j]) / size);
    }
  }
  const diagonal = m.map((row, i) => row[i]);
  const rounding = n * Number.EPSILON;
  for (let j = 0; j < n; j++) {
    for (let i = j; i < n; i++) m[i][j] = m[i][j] - product(m[j], m[i], j);
    const pivot = m[j][j];
    if (Number.isNaN(pivot) || pivot <= rounding * Math.abs(diagonal[j])) return null;
    const root = Math.sqrt(pivot);
    for (let i = j; i < n; i++) m[i][j] = m[i][j] / root;
  }
  return m;
}

/** The least change δ with `A δ = −residual` of these rows; the others only take part in the metric if they must. */
function leastChange(mass, jacobian, residual, takesPart) {
  const n = mass.length;
  const taking = jacobian.map((_, row) => row).filter(takesPart);
  const scales = scalesOf(mass, jacobian);
  const l = factorized(mass, taking.map((row) => jacobian[row]), scales) ?? factorized(mass, jacobian, scales);
  if (l === null) throw new Error("a motion that the constraints leave has no inertia");
  const rows = jacobian.map((a) => {
    const x = a.map((value, i) => value * scales[i]);
    for (let i = 0; i < n; i++) x[i] = (x[i] - product(l[i], x, i)) / l[i][i];
    return x;
  });
  const targets = residual.map((x) => -x);
  const lengths = rows.map((row) => Math.sqrt(product(row, row)));
  const change = new Array(n).fill(0);
  let waiting = taking;
  while (waiting.length > 0) {
    const share = (row) => {
      const rest = Math.sqrt(product(rows[row], rows[row]));
      return rest === 0 ? rest : rest / lengths[row];
    };
    const row = waiting.reduce((a, b) => (share(b) > share(a) || Number.isNaN(share(b)) ? b : a));
    if (Number.isNaN(share(row))) throw new Error("a constraint is not a number");
    if (share(row) <= ROOT * 1e-2) break;
    waiting = waiting.filter((other) => other !== row);
    const length = Math.sqrt(product(rows[row], rows[row]));
    const target = targets[row] / length;
    for (let i = 0; i < n; i++) {
      rows[row][i] = rows[row][i] / length;
      change[i] = change[i] + target * rows[row][i];
    }
    for (const other of waiting) {
      const along = product(rows[row], rows[other]);
      for (let i = 0; i < n; i++) rows[other][i] = rows[other][i] - along * rows[row][i];
      targets[other] = targets[other] - along * target;
    }
  }
  for (let i = n - 1; i >= 0; i--) {
    change[i] = change[i] / l[i][i];
    for (let j = 0; j < i; j++) change[j] = change[j] - l[i][j] * change[i];
  }
  return change.map((x, i) => x * scales[i]);
}

/** The first row that more than rounding of this size leaves open. */
function open(constraints, t, q, residual, size) {
  const jacobian = constraints.jacobian(t, q);
  const allowed = (row) => ROOT * size * jacobian[row].reduce((sum, a) => sum + Math.abs(a), 0);
  return residual.findIndex((x, row) => Number.isNaN(x) || Math.abs(x) > allowed(row));
}

/** The positions that Newton's method finds with `φ(q) = 0`. */
function closed(constraints, t, start) {
  const { holonomic } = constraints;
  if (!holonomic.some(Boolean)) return start;
  const at = (q) => constraints.position(t, q).map((x, row) => (holonomic[row] ? x : 0));
  const check = (q, residual, size) => {
    const row = open(constraints, t, q, residual, size);
    if (row >= 0) throw new Error(`the constraints do not close: ${constraints.names[row]} stays open`);
    return q;
  };
  let q = start;
  let residual = at(q);
  for (let iteration = 0; iteration < MOST_ITERATIONS; iteration++) {
    const before = greatest(residual);
    if (!(before < Infinity)) throw new Error("a constraint is not a number");
    if (before === 0) return q;
    const change = leastChange(constraints.mass(t, q), constraints.jacobian(t, q), residual, (row) => holonomic[row]);
    const [size, step] = [greatest(q, 1), greatest(change)];
    const begin = q;
    let share = step > size ? size / step : 1;
    for (let halving = 0; halving <= MOST_HALVINGS; halving++) {
      q = begin.map((x, i) => x + share * change[i]);
      residual = at(q);
      const now = allFinite(residual) ? greatest(residual) : Infinity;
      if (now < before || halving === MOST_HALVINGS) break;
      share = share * 0.5;
    }
    if (!(greatest(residual) < before)) return check(begin, at(begin), size);
    if (share === 1 && step <= size * ROOT * 1e-2) return check(q, residual, size);
  }
  return check(q, residual, 0);
}

/** A state on the constraints: `{ names, holonomic, mass(t, q), position(t, q), rate(t, q, qd), jacobian(t, q) }`. */
export function project(constraints, t, state) {
  const q = closed(constraints, t, state.q);
  let qd = state.qd;
  // A second time for the rounding of the first.
  for (let time = 0; time < 2; time++) {
    const rate = constraints.rate(t, q, qd);
    const change = leastChange(constraints.mass(t, q), constraints.jacobian(t, q), rate, () => true);
    qd = qd.map((x, i) => x + change[i]);
  }
  const speed = greatest(qd, ROOT);
  const row = open(constraints, t, q, constraints.rate(t, q, qd), speed);
  if (row >= 0) throw new Error(`the constraints contradict each other: ${constraints.names[row]}`);
  if (!allFinite(q) || !allFinite(qd)) throw new Error("a constraint is not a number");
  return { q, qd };
}
