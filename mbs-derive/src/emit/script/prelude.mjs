/** -1, 0 or 1; NaN of NaN. */
function mbs_signum(x) {
  return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x * 0.0;
}


/** Sine and cosine from +, - and * alone, the same bits as mbs-runtime's `sin_cos_all`, which says where they are from. */
function mbs_sin_cos(x) {
  if (!(Math.abs(x) <= 1e5)) {
    return [Math.sin(x), Math.cos(x)];
  }
  // x = k pi/2 + y - e
  const k = x * 0.6366197723675814 + 6755399441055744.0 - 6755399441055744.0;
  const r = x - k * 1.5707963267341256;
  const w = k * 6.077100506303966e-11;
  const h = r - w;
  const t = k * 2.0222662487959506e-21 - (r - h - w);
  const y = h - t;
  const e = t - (h - y);
  const z = y * y;
  const z2 = z * z;
  const z4 = z2 * z2;
  const p =
    -0.1666666666666663 + z * 0.00833333333332184 + z2 * (-0.00019841269829358541 + z * 2.7557313538526334e-6) +
    z4 * (-2.5050734392422683e-8 + z * 1.5895433544930663e-10);
  const q =
    0.041666666666666595 + z * -0.001388888888887334 + z2 * (2.4801587288999616e-5 + z * -2.755731421606095e-7) +
    z4 * (2.087570523233725e-9 + z * -1.1358739381498488e-11);
  const half = 0.5 * z;
  const one = 1.0 - half;
  const sin = y - (e * one - z * y * p);
  const cos = one + (1.0 - one - half + (z2 * q + y * e));
  switch (k & 3) {
    case 0:
      return [sin, cos];
    case 1:
      return [cos, -sin];
    case 2:
      return [-sin, -cos];
    default:
      return [-cos, sin];
  }
}


/** Sines and cosines of several angles. */
function mbs_sin_cos_all(angles) {
  const sines = new Float64Array(angles.length);
  const cosines = new Float64Array(angles.length);
  for (let i = 0; i < angles.length; i++) {
    [sines[i], cosines[i]] = mbs_sin_cos(angles[i]);
  }
  return [sines, cosines];
}


function mbs_own_sin(x) {
  return mbs_sin_cos(x)[0];
}


function mbs_own_cos(x) {
  return mbs_sin_cos(x)[1];
}


/** As many numbers as a mechanism has; of prescribed motions as many times three. */
function mbs_sized(name, values, count) {
  if (values === undefined || values === null || values.length !== count) {
    throw new RangeError(`${name} must have ${count} numbers, not ${values?.length}`);
  }
  for (let i = 0; i < count; i++) {
    if (name === "prescribed") {
      mbs_sized(`prescribed[${i}]`, values[i], 3);
    } else if (typeof values[i] !== "number") {
      throw new RangeError(`${name}[${i}] must be a number, not ${typeof values[i]}`);
    }
  }
}


/** Known parameters, all of them finite. */
function mbs_parameters(defaults, given) {
  const isList = (value) => Array.isArray(value) || ArrayBuffer.isView(value);
  const sizes = (value) => (isList(value) ? `[${Array.from(value, sizes).join()}]` : typeof value);
  const finite = (value) => (typeof value === "number" ? Number.isFinite(value) : Array.from(value).every(finite));
  for (const [name, value] of Object.entries(given)) {
    if (!Object.hasOwn(defaults, name)) {
      throw new RangeError(`there is no parameter ${name}; there are ${Object.keys(defaults).join(", ")}`);
    }
    if (sizes(value) !== sizes(defaults[name])) {
      throw new RangeError(`parameter ${name} must be like ${JSON.stringify(defaults[name])}, not ${sizes(value)}`);
    }
    if (!finite(value)) {
      throw new RangeError(`parameter ${name} must be finite, not ${value}`);
    }
  }
  return Object.freeze({ ...defaults, ...given });
}


/** A flat array as rows of this many numbers. */
function mbs_rows(values, columns) {
  const rows = [];
  for (let first = 0; first < values.length; first += columns) {
    rows.push(values.slice(first, first + columns));
  }
  return rows;
}


/** A derivative of a piecewise polynomial: a row has its origin, then coefficients from the constant on. */
function mbs_spline(places, rows, order, x) {
  let first = 0;
  let last = places.length;
  while (first < last) {
    const middle = first + Math.floor((last - first) / 2);
    if (x < places[middle]) {
      last = middle;
    } else {
      first = middle + 1;
    }
  }
  const row = rows[first];
  const s = x - row[0];
  let sum = s * 0.0;
  for (let power = row.length - 2; power >= order; power--) {
    let factor = 1;
    for (let k = power + 1 - order; k <= power; k++) {
      factor *= k;
    }
    sum = factor * row[1 + power] + s * sum;
  }
  return sum;
}


/** M = L D L^T in place of the lower triangle of an n by n matrix; 1/D. No pivoting: M is positive definite. */
function mbs_ldlt(n, m) {
  const reciprocals = new Array(n);
  for (let k = 0; k < n; k++) {
    reciprocals[k] = 1.0 / m[k * n + k];
    for (let i = k + 1; i < n; i++) {
      const u = m[i * n + k];
      for (let j = k + 1; j <= i; j++) {
        // Column k of L has replaced what was above row i.
        const l = j < i ? m[j * n + k] : u * reciprocals[k];
        m[i * n + j] = m[i * n + j] - u * l;
      }
      m[i * n + k] = u * reciprocals[k];
    }
  }
  return reciprocals;
}


/** X of M X = B in place of B, rows of this many columns. */
function mbs_ldlt_solve(n, columns, m, reciprocals, b) {
  for (let c = 0; c < columns; c++) {
    for (let k = 0; k < n; k++) {
      for (let i = k + 1; i < n; i++) {
        b[i * columns + c] = b[i * columns + c] - m[i * n + k] * b[k * columns + c];
      }
    }
    for (let i = n - 1; i >= 0; i--) {
      let x = b[i * columns + c] * reciprocals[i];
      for (let k = i + 1; k < n; k++) {
        x = x - m[k * n + i] * b[k * columns + c];
      }
      b[i * columns + c] = x;
    }
  }
  return b;
}


function mbs_magnitude(x) {
  return x < 0.0 ? -x : x;
}


function mbs_larger(a, b) {
  return a < b ? b : a;
}


function mbs_largest(values) {
  return values.reduce((largest, x) => mbs_larger(largest, mbs_magnitude(x)), 0.0);
}


function mbs_is_finite(x) {
  return mbs_magnitude(x) < Infinity;
}


const mbs_bits = new DataView(new ArrayBuffer(8));


/** The exponent of a number that is not zero, else null; of a subnormal one that of the smallest normal one. */
function mbs_exponent(x) {
  if (x === 0.0) {
    return null;
  }
  mbs_bits.setFloat64(0, x);
  return Math.max(((mbs_bits.getUint32(0) >>> 20) & 0x7ff) - 1023, -1022);
}


/** A number times a power of two. */
function mbs_scaled(x, exponent) {
  let rest = exponent;
  const power = (n) => {
    mbs_bits.setUint32(0, (1023 + n) << 20);
    mbs_bits.setUint32(4, 0);
    return mbs_bits.getFloat64(0);
  };
  while (Math.abs(rest) > 100) {
    const step = Math.max(-100, Math.min(100, rest));
    x = x * power(step);
    rest -= step;
  }
  return x * power(rest);
}


/** The greatest of some numbers, those that are null left out; null of none. */
function mbs_most(values) {
  return values.reduce((most, x) => (x !== null && (most === null || x > most) ? x : most), null);
}


function mbs_range(first, end) {
  const numbers = [];
  for (let i = first; i < end; i++) {
    numbers.push(i);
  }
  return numbers;
}


/** Exponents by which M and A are scaled, as mbs-runtime's `dynamics/scaling.rs` finds them. */
class mbs_Scales {
  constructor(n, diagonal, a, vectors) {
    this.n = n;
    this.k = a.length;
    this.inertia = diagonal.map(mbs_exponent);
    this.slopes = a.map((row) => row.map(mbs_exponent));
    this.taken = new Array(n).fill(null);
    this.vectors = vectors;
    this.forget_rounding();
    this.assign();
    const reference = this.inertia.find((size) => size !== null) ?? 0;
    this.columns = this.sizes().map((size) => Math.floor((size - reference) / 2));
    const sizes = a.map((_, row) => this.row_sizes(row));
    this.small = sizes.map(([own, size]) => size - own);
    this.rows = sizes.map(([, size]) => size);
    this.mass = reference;
  }

  forget_rounding() {
    for (let i = 0; i < this.n; i++) {
      for (let row = 0; row < this.k; row++) {
        const beside = mbs_most(this.slopes.filter((_, k) => this.vectors[k] === this.vectors[row]).map((s) => s[i]));
        const own = this.slopes[row][i];
        if (own !== null && beside > own + 46) {
          this.slopes[row][i] = null;
        }
      }
    }
  }

  assign() {
    const { n, k, taken } = this;
    const weight = (row, i) => {
      const slope = this.slopes[row][i];
      return slope === null ? null : 2 * slope - (this.inertia[i] ?? -(2 ** 32));
    };
    const u = new Array(k).fill(0);
    const v = new Array(n).fill(0);
    for (let start = 0; start < k; start++) {
      const distance = new Array(n).fill(Infinity);
      const before = new Array(n).fill(n);
      const visited = new Array(n).fill(false);
      let [row, last, so_far, column] = [start, n, 0, null];
      const weights = mbs_range(0, n).map((i) => {
        const own = weight(start, i);
        return own === null ? null : own + v[i];
      });
      u[start] = -(mbs_most(weights) ?? 0);
      for (;;) {
        for (let i = 0; i < n; i++) {
          const own = weight(row, i);
          if (visited[i] || own === null) {
            continue;
          }
          const through = so_far - own - u[row] - v[i];
          if (through < distance[i]) {
            distance[i] = through;
            before[i] = last;
          }
        }
        let next = null;
        for (let i = 0; i < n; i++) {
          if (!visited[i] && (next === null || distance[i] < distance[next])) {
            next = i;
          }
        }
        if (next === null || distance[next] === Infinity) {
          break;
        }
        visited[next] = true;
        so_far = distance[next];
        last = next;
        if (taken[next] === null) {
          column = next;
          break;
        }
        row = taken[next];
      }
      if (column === null) {
        continue;
      }
      for (let i = 0; i < n; i++) {
        if (visited[i] && i !== column) {
          v[i] -= so_far - distance[i];
          if (taken[i] !== null) {
            u[taken[i]] += so_far - distance[i];
          }
        }
      }
      u[start] += so_far;
      while (before[column] < n) {
        taken[column] = taken[before[column]];
        column = before[column];
      }
      taken[column] = start;
    }
  }

  sizes() {
    const { n } = this;
    const sizes = this.inertia.slice();
    this.raise(sizes);
    const massless = mbs_range(0, n).filter((i) => this.taken[i] !== null && this.inertia[i] === null);
    for (const i of massless) {
      sizes[i] = null;
    }
    this.relax(sizes, massless);
    for (;;) {
      const i = massless.find((other) => sizes[other] === null);
      if (i === undefined) {
        break;
      }
      sizes[i] = this.lower_bound(sizes, i) ?? 0;
      this.relax(sizes, massless);
    }
    return sizes.map((size, i) => size ?? this.lower_bound(sizes, i) ?? 0);
  }

  raise(sizes) {
    for (let round = 0; round <= this.k; round++) {
      let changed = false;
      for (let i = 0; i < this.n; i++) {
        const bound = this.taken[i] === null ? null : this.lower_bound(sizes, i);
        if (bound !== null && (sizes[i] === null || bound > sizes[i])) {
          sizes[i] = bound;
          changed = true;
        }
      }
      if (!changed) {
        return;
      }
    }
  }

  relax(sizes, massless) {
    for (let round = 0; round <= this.k; round++) {
      let changed = false;
      for (const i of massless) {
        const row = this.slopes[this.taken[i]];
        if (row[i] === null) {
          continue;
        }
        let least = null;
        for (let j = 0; j < this.n; j++) {
          if (j !== i && row[j] !== null && sizes[j] !== null) {
            const bound = 2 * (row[i] - row[j]) + sizes[j];
            least = least === null || bound < least ? bound : least;
          }
        }
        if (least !== null && (sizes[i] === null || least < sizes[i])) {
          sizes[i] = least;
          changed = true;
        }
      }
      if (!changed) {
        return;
      }
    }
  }

  /** Of the row, and of its vector in the coordinates that it moves. */
  row_sizes(row) {
    const vector = this.slopes.filter((_, k) => this.vectors[k] === this.vectors[row]);
    const all = mbs_range(0, this.n);
    const greatest = (i) => {
      const most = mbs_most(vector.map((slopes) => slopes[i]));
      return most === null ? null : most - this.columns[i];
    };
    const moved = all.filter((i) => this.slopes[row][i] !== null);
    const own = mbs_most(moved.map((i) => this.slopes[row][i] - this.columns[i]));
    const size = mbs_most(moved.map(greatest)) ?? mbs_most(all.map(greatest)) ?? 0;
    return [own ?? size - 46, size];
  }

  lower_bound(sizes, coordinate) {
    const bound = (i) => {
      if (i === coordinate || this.taken[i] === null || sizes[i] === null) {
        return null;
      }
      const row = this.slopes[this.taken[i]];
      return row[coordinate] === null || row[i] === null ? null : sizes[i] + 2 * (row[coordinate] - row[i]);
    };
    return mbs_most(mbs_range(0, this.n).map(bound));
  }
}


/** M q'' - A^T l = f, A q'' = c in a basis of the null space of A, as mbs-runtime's `dynamics/null_space.rs`. */
class mbs_NullSpace {
  constructor(n, vectors, mass, jacobian) {
    const m = (i, j) => mass[Math.max(i, j) * n + Math.min(i, j)];
    const a = mbs_rows(jacobian, n);
    const k = vectors.length;
    const zeros = (rows, columns) => mbs_range(0, rows).map(() => new Array(columns).fill(0.0));
    const triangle = mbs_range(0, n).flatMap((i) => mbs_range(0, i + 1).map((j) => m(i, j)));
    this.is_regular = triangle.concat(jacobian).every(mbs_is_finite);
    if (!this.is_regular) {
      return;
    }
    const diagonal = mbs_range(0, n).map((i) => m(i, i));
    const scales = new mbs_Scales(n, diagonal, a, vectors);
    const { columns: s, rows: t } = scales;
    Object.assign(this, { n, k, vectors, scales, rank: 0 });
    const all = mbs_range(0, n);
    this.mass = all.map((i) => all.map((j) => mbs_scaled(m(i, j), -s[i] - s[j] - scales.mass)));
    this.slopes = a.map((row, l) => row.map((x, i) => mbs_scaled(x, -s[i] - t[l])));
    this.basis = this.slopes.map((row) => row.slice());
    this.reciprocals = new Array(k).fill(0.0);
    this.rows = mbs_range(0, k);
    this.columns = all.slice();
    this.inertia = zeros(n, n);
    this.compliance = new Array(n).fill(0.0);
    this.gram = zeros(k, k);
    this.eliminate();
    this.solve_for_dependent_coordinates();
    this.is_regular = this.factorize(this.reduce());
    if (this.is_regular) {
      this.relate_redundant_rows();
    }
  }

  eliminate() {
    for (let pivot = this.pivot(); pivot !== null; pivot = this.pivot()) {
      const [row, column] = pivot;
      const p = this.rank;
      const swap = (list, i, j) => ([list[i], list[j]] = [list[j], list[i]]);
      swap(this.basis, p, row);
      swap(this.rows, p, row);
      this.basis.forEach((other) => swap(other, p, column));
      swap(this.columns, p, column);
      const pivots = this.basis[p];
      this.reciprocals[p] = 1.0 / pivots[p];
      for (const other of this.basis.slice(p + 1)) {
        other[p] = other[p] * this.reciprocals[p];
        for (let j = p + 1; j < this.n; j++) {
          other[j] = other[j] - other[p] * pivots[j];
        }
      }
      this.rank += 1;
    }
  }

  pivot() {
    const { n, k, rank, basis } = this;
    const size = ([row, i]) => mbs_magnitude(basis[row][i]);
    const entries = [];
    for (let row = rank; row < k; row++) {
      const own = mbs_range(rank, n).map((i) => [row, i]);
      const least = this.least_slope(this.rows[row]);
      if (own.some((entry) => least < size(entry))) {
        entries.push(...own);
      }
    }
    if (entries.length === 0) {
      return null;
    }
    const largest = entries.reduce((best, entry) => (size(best) < size(entry) ? entry : best));
    const enough = size(largest) * 0.5;
    let gentlest = null;
    for (const entry of entries) {
      const [row, i] = entry;
      if (this.scales.taken[this.columns[i]] !== this.rows[row] || size(entry) < enough) {
        continue;
      }
      const growth = this.growth(row, i);
      if (gentlest === null || growth < gentlest[0]) {
        gentlest = [growth, entry];
      }
    }
    return gentlest === null ? largest : gentlest[1];
  }

  least_slope(row) {
    const least = 1.4901161193847656e-8 * 1e-2;
    const small = this.scales.small[row];
    return small === 0 ? least : mbs_larger(mbs_scaled(least, -small), 16.0 * Number.EPSILON);
  }

  growth(row, column) {
    const others = mbs_range(this.rank, this.n).filter((i) => i !== column);
    const along = mbs_most(others.map((i) => mbs_exponent(this.basis[row][i])));
    const rows = mbs_range(this.rank, this.k).filter((k) => k !== row);
    const across = mbs_most(rows.map((k) => mbs_exponent(this.basis[k][column])));
    const own = mbs_exponent(this.basis[row][column]);
    return along === null || across === null || own === null ? -Infinity : along + across - own;
  }

  solve_for_dependent_coordinates() {
    const { n, rank, basis } = this;
    for (let p = rank - 1; p >= 0; p--) {
      for (let j = rank; j < n; j++) {
        let rest = basis[p][j];
        for (let i = p + 1; i < rank; i++) {
          rest = rest - basis[p][i] * basis[i][j];
        }
        basis[p][j] = rest * this.reciprocals[p];
      }
    }
  }

  reduce() {
    const [r, s, w] = [this.rank, this.n - this.rank, this.basis];
    const m = (i, j) => this.mass[this.columns[i]][this.columns[j]];
    const carried = mbs_range(0, r).map((p) =>
      mbs_range(0, s).map((j) => mbs_range(0, r).reduce((sum, i) => sum - m(p, i) * w[i][r + j], m(p, r + j))),
    );
    for (let i = 0; i < s; i++) {
      for (let j = 0; j <= i; j++) {
        const direct = mbs_range(0, r).reduce((sum, p) => sum - m(r + i, p) * w[p][r + j], m(r + i, r + j));
        this.inertia[i][j] = mbs_range(0, r).reduce((sum, p) => sum - w[p][r + i] * carried[p][j], direct);
      }
    }
    const term = (p, i) => w[p][r + i] * w[p][r + i] * mbs_magnitude(m(p, p));
    return mbs_range(0, s).map((i) => {
      const own = mbs_magnitude(m(r + i, r + i));
      return mbs_range(0, r).reduce((sum, p) => sum + term(p, i), own) * (r + 1.0);
    });
  }

  factorize(bounds) {
    const { n, rank, inertia, compliance } = this;
    const s = n - rank;
    const weights = bounds.map((bound) => 1.0 / bound);
    for (let p = 0; p < s; p++) {
      const share = (i) => inertia[i][i] * weights[i];
      const pivot = mbs_range(p + 1, s).reduce((best, i) => (share(best) < share(i) ? i : best), p);
      if (!(16.0 * n * Number.EPSILON < share(pivot))) {
        return false;
      }
      this.exchange(p, pivot);
      [weights[p], weights[pivot]] = [weights[pivot], weights[p]];
      compliance[p] = 1.0 / inertia[p][p];
      const column = mbs_range(0, s).map((i) => inertia[i][p] * compliance[p]);
      for (let i = p + 1; i < s; i++) {
        const u = inertia[i][p];
        for (let j = p + 1; j <= i; j++) {
          inertia[i][j] = inertia[i][j] - u * column[j];
        }
        inertia[i][p] = column[i];
      }
    }
    return true;
  }

  exchange(p, i) {
    if (p === i) {
      return;
    }
    const { rank: r, inertia } = this;
    const s = this.n - r;
    const swap = (list, a, b) => ([list[a], list[b]] = [list[b], list[a]]);
    for (let other = 0; other < s; other++) {
      if (other === p || other === i) {
        continue;
      }
      const place = (x) => (other < p ? [x, other] : [Math.max(x, other), Math.min(x, other)]);
      const [a, b] = [place(p), place(i)];
      [inertia[a[0]][a[1]], inertia[b[0]][b[1]]] = [inertia[b[0]][b[1]], inertia[a[0]][a[1]]];
    }
    [inertia[p][p], inertia[i][i]] = [inertia[i][i], inertia[p][p]];
    swap(this.columns, r + p, r + i);
    this.basis.forEach((row) => swap(row, r + p, r + i));
  }

  relate_redundant_rows() {
    const { rank: r, k, basis, gram } = this;
    for (let row = r; row < k; row++) {
      for (let p = r - 1; p >= 0; p--) {
        for (let i = p + 1; i < r; i++) {
          basis[row][p] = basis[row][p] - basis[row][i] * basis[i][p];
        }
      }
    }
    for (let row = r; row < k; row++) {
      for (let l = r; l <= row; l++) {
        let sum = row === l ? 1.0 : 0.0;
        for (let p = 0; p < r; p++) {
          sum = sum + basis[row][p] * basis[l][p];
        }
        for (let i = r; i < l; i++) {
          sum = sum - gram[row][i] * gram[l][i] * gram[i][i];
        }
        gram[row][l] = row === l ? sum : sum / gram[l][l];
      }
    }
  }

  /** Of columns of f, then c; `motion` and `sizes` of slopes, else empty. */
  solve(columns, motion, sizes) {
    const { n, k, scales } = this;
    const none = new Array(n + k).fill(NaN);
    if (!this.is_regular || !motion.every(mbs_is_finite)) {
      return columns.map(() => none);
    }
    const { columns: s, rows: t, mass } = scales;
    const scaled = columns.map((column) => [
      column.slice(0, n).map((x, i) => mbs_scaled(x, -s[i] - mass)),
      column.slice(n).map((x, l) => mbs_scaled(x, -t[l])),
    ]);
    const greatest = this.rank === k ? [] : this.greatest_sizes(scaled, motion, sizes);
    return scaled.map(([force, target], j) => {
      const q = this.motion(force, target);
      if (this.rank < k) {
        let own = target.map(mbs_magnitude);
        const scale = sizes.length > 0 ? mbs_magnitude(sizes[j]) : 0.0;
        if (0.0 < scale) {
          own = own.map((size, l) => mbs_larger(size, greatest[l] / scale));
        }
        if (!this.agrees(q, target, own)) {
          return none;
        }
      }
      const l = this.multipliers(q, force);
      const all = q.map((x, i) => mbs_scaled(x, -s[i])).concat(l.map((x, row) => mbs_scaled(x, mass - t[row])));
      return all.every(mbs_is_finite) ? all : none;
    });
  }

  greatest_sizes(columns, motion, sizes) {
    const greatest = new Array(this.k).fill(0.0);
    if (motion.length === 0) {
      return greatest;
    }
    let fastest = mbs_largest(motion.map((x, i) => mbs_scaled(x, this.scales.columns[i])));
    columns.forEach(([force, target], j) => {
      const scale = mbs_magnitude(sizes[j]);
      fastest = mbs_larger(fastest, mbs_largest(this.motion(force, target)) * scale);
      target.forEach((x, l) => (greatest[l] = mbs_larger(greatest[l], mbs_magnitude(x) * scale)));
    });
    return greatest.map((size, l) => (0.0 < mbs_largest(this.slopes[l]) ? mbs_larger(size, fastest) : size));
  }

  motion(force, target) {
    const { n, rank: r, basis, inertia } = this;
    const s = n - r;
    const m = (i, j) => this.mass[this.columns[i]][this.columns[j]];
    const q = new Array(n).fill(0.0);
    for (let p = 0; p < r; p++) {
      q[p] = mbs_range(0, p).reduce((sum, i) => sum - basis[p][i] * q[i], target[this.rows[p]]);
    }
    for (let p = r - 1; p >= 0; p--) {
      q[p] = mbs_range(p + 1, r).reduce((sum, i) => sum - basis[p][i] * q[i], q[p]) * this.reciprocals[p];
    }
    const left = (i) => mbs_range(0, r).reduce((sum, p) => sum - m(i, p) * q[p], force[this.columns[i]]);
    const rest = mbs_range(0, n).map(left);
    for (let i = 0; i < s; i++) {
      const along = mbs_range(0, r).reduce((sum, p) => sum - basis[p][r + i] * rest[p], rest[r + i]);
      q[r + i] = mbs_range(0, i).reduce((sum, j) => sum - inertia[i][j] * q[r + j], along);
    }
    for (let i = s - 1; i >= 0; i--) {
      const scaled = q[r + i] * this.compliance[i];
      q[r + i] = mbs_range(i + 1, s).reduce((sum, j) => sum - inertia[j][i] * q[r + j], scaled);
    }
    for (let p = 0; p < r; p++) {
      q[p] = mbs_range(r, n).reduce((sum, i) => sum - basis[p][i] * q[i], q[p]);
    }
    const ordered = q.slice();
    this.columns.forEach((i, place) => (ordered[i] = q[place]));
    return ordered;
  }

  size(row, motion, sizes) {
    const along = (l) => this.slopes[l].reduce((sum, a, i) => sum + mbs_magnitude(a) * mbs_magnitude(motion[i]), 0.0);
    const own = sizes[row] + along(row);
    if (!(mbs_largest(this.slopes[row]) < 1.0)) {
      return own;
    }
    const others = mbs_range(0, this.k).filter((l) => l !== row && this.vectors[l] === this.vectors[row]);
    const { rows: t } = this.scales;
    return others.reduce((size, l) => mbs_larger(size, mbs_scaled(sizes[l] + along(l), t[l] - t[row])), own);
  }

  agrees(motion, target, sizes) {
    return mbs_range(this.rank, this.k).every((l) => {
      const row = this.rows[l];
      let rest = target[row];
      let size = this.size(row, motion, sizes);
      for (let p = 0; p < this.rank; p++) {
        const factor = this.basis[l][p];
        rest = rest - factor * target[this.rows[p]];
        size = size + mbs_magnitude(factor) * this.size(this.rows[p], motion, sizes);
      }
      const left = (i) => mbs_magnitude(this.basis[l][i]) * mbs_magnitude(motion[this.columns[i]]);
      const allowed = mbs_range(this.rank, this.n).reduce((sum, i) => sum + left(i), size * 1.4901161193847656e-8);
      return mbs_magnitude(rest) < allowed || rest === 0.0;
    });
  }

  multipliers(motion, force) {
    const { n, k, rank: r, basis, gram } = this;
    const l = new Array(k).fill(0.0);
    for (let p = 0; p < r; p++) {
      const i = this.columns[p];
      const h = mbs_range(0, n).reduce((sum, j) => sum + this.mass[i][j] * motion[j], -force[i]);
      l[p] = mbs_range(0, p).reduce((sum, q) => sum - basis[q][p] * l[q], h) * this.reciprocals[p];
    }
    for (let p = r - 1; p >= 0; p--) {
      l[p] = mbs_range(p + 1, r).reduce((sum, row) => sum - basis[row][p] * l[row], l[p]);
    }
    for (let row = r; row < k; row++) {
      const along = mbs_range(0, r).reduce((sum, p) => sum + basis[row][p] * l[p], 0.0);
      l[row] = mbs_range(r, row).reduce((sum, i) => sum - gram[row][i] * l[i], along);
    }
    for (let row = k - 1; row >= r; row--) {
      l[row] = mbs_range(row + 1, k).reduce((sum, i) => sum - gram[i][row] * l[i], l[row] / gram[row][row]);
    }
    for (let p = 0; p < r; p++) {
      l[p] = mbs_range(r, k).reduce((sum, row) => sum - basis[row][p] * l[row], l[p]);
    }
    const ordered = l.slice();
    this.rows.forEach((row, place) => (ordered[row] = l[place]));
    return ordered;
  }
}


/** How large coordinates, speeds and inputs are by which accelerations are differentiated. */
function mbs_state_sizes(q, qd, kinds, inputs) {
  const largest = (values, kind) => mbs_largest(Array.from(values).filter((_, i) => kinds[i] === kind));
  const places = kinds.map((kind) => (kind === 0 ? 1.0 : largest(q, kind)));
  return places.concat(kinds.map((kind) => largest(qd, kind))).concat(new Array(inputs).fill(0.0));
}


/** Derivatives of a constrained motion, flat parts of these many columns: of right sides part by part, row by row. */
function mbs_slopes(system, right_sides, widths, motion, sizes) {
  const { n, k } = system;
  const columns = [];
  let first = 0;
  for (const width of widths) {
    for (let column = 0; column < width; column++) {
      columns.push(mbs_range(0, n + k).map((row) => right_sides[first + row * width + column]));
    }
    first += (n + k) * width;
  }
  const solved = system.solve(columns, motion, sizes);
  return widths.map((width) => {
    const part = solved.splice(0, width);
    return mbs_range(0, n).flatMap((i) => part.map((column) => column[i]));
  });
}
