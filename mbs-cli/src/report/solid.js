// Small linear algebra of the picture, and what bodies look like.

export const identity = () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** Product of matrices of four columns, each column four numbers in a row. */
export function multiply(a, b) {
  const out = new Array(16);
  for (let c = 0; c < 4; c++) {
    for (let r = 0; r < 4; r++) {
      out[4 * c + r] = a[r] * b[4 * c] + a[4 + r] * b[4 * c + 1] + a[8 + r] * b[4 * c + 2] + a[12 + r] * b[4 * c + 3];
    }
  }
  return out;
}

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => scale(a, 1 / (length(a) || 1));

/** Axes as columns, and an origin. */
export const placed = ([x, y, z], o) => [...x, 0, ...y, 0, ...z, 0, ...o, 1];

/** `R v` of rows. */
export const turned = (rows, v) => rows.map((row) => dot(row, v));

/** A frame `{ position, rotation }` as a matrix. */
export function pose({ position, rotation: r }) {
  const column = (i) => [r[0][i], r[1][i], r[2][i]];
  return placed([column(0), column(1), column(2)], position);
}

export function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2);
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
}

export function lookAt(eye, centre, up) {
  const back = unit(sub(eye, centre));
  const right = unit(cross(up, back));
  const above = cross(back, right);
  const [x, y, z] = [0, 1, 2].map((i) => [right[i], above[i], back[i]]);
  return placed([x, y, z], [-dot(right, eye), -dot(above, eye), -dot(back, eye)]);
}

/** A cylinder's axis from a place to another, of this radius. */
export function between(from, to, radius) {
  const way = sub(to, from);
  const along = unit(way);
  const aside = unit(cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  return placed([scale(aside, radius), scale(cross(along, aside), radius), way], from);
}

/**
 * Eigenvalues and eigenvectors, as columns, of a symmetric matrix of three rows.
 *
 * Source: Jacobi's method; G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed. 2013, section 8.5.
 */
export function principal(matrix) {
  const a = matrix.map((row) => row.slice());
  const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 30; sweep++) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (Math.abs(a[p][q]) <= 1e-15 * (Math.abs(a[p][p]) + Math.abs(a[q][q]))) continue;
      const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
      const c = 1 / Math.sqrt(t * t + 1);
      const s = t * c;
      for (let k = 0; k < 3; k++) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
      for (let k = 0; k < 3; k++) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
      for (let k = 0; k < 3; k++) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
    }
  }
  return { values: [a[0][0], a[1][1], a[2][2]], vectors: v };
}

/** Half axes of the uniform ellipsoid with this mass and inertia, `a² = 5 (I₂ + I₃ − I₁)/2m`; none of points. */
export function ellipsoid(mass, [xx, yy, zz, xy, xz, yz]) {
  const { values, vectors } = principal([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
  const sum = values[0] + values[1] + values[2];
  if (!(mass > 0 && sum > 0)) return undefined;
  const axes = values.map((own) => Math.sqrt(Math.max(0, (2.5 * (sum - 2 * own)) / mass)));
  return { axes, vectors };
}

/** Place, axes and size of an ellipsoid as a matrix; thin ones have at least this half axis. */
export function solid(centre, { axes, vectors }, least) {
  const column = (i) => scale([vectors[0][i], vectors[1][i], vectors[2][i]], Math.max(axes[i], least));
  return placed([column(0), column(1), column(2)], centre);
}
