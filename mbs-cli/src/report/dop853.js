// Dormand and Prince's method of order 8(5,3), as `mbs_runtime::Dop853` has it: the same operations in the same
// order, so that a motion in the page is the one that `mbs simulate` writes.
//
// Source: E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. 1993, II.4 to II.6,
// and their code DOP853; coefficients as in `mbs-runtime/src/integrator/dop853/tableau.rs`.

/** When the stages are, in steps; 12 is the end of the step, 13 to 15 serve the dense output. */
const NODES = [
  0.0, 0.05260015195876773, 0.0789002279381516, 0.1183503419072274, 0.2816496580927726, 0.3333333333333333, 0.25,
  0.3076923076923077, 0.6512820512820513, 0.6, 0.8571428571428571, 1.0, 1.0, 0.1, 0.2, 0.7777777777777778,
];

/** Rows of `a`: a stage and its weight. */
const A = [
  [],
  [[0, 0.05260015195876773]],
  [[0, 0.0197250569845379], [1, 0.0591751709536137]],
  [[0, 0.02958758547680685], [2, 0.08876275643042054]],
  [[0, 0.2413651341592667], [2, -0.8845494793282861], [3, 0.924834003261792]],
  [[0, 0.037037037037037035], [3, 0.17082860872947386], [4, 0.12546768756682242]],
  [[0, 0.037109375], [3, 0.17025221101954405], [4, 0.06021653898045596], [5, -0.017578125]],
  [
    [0, 0.03709200011850479], [3, 0.17038392571223998], [4, 0.10726203044637328], [5, -0.015319437748624402],
    [6, 0.008273789163814023],
  ],
  [
    [0, 0.6241109587160757], [3, -3.3608926294469414], [4, -0.868219346841726], [5, 27.59209969944671],
    [6, 20.154067550477894], [7, -43.48988418106996],
  ],
  [
    [0, 0.47766253643826434], [3, -2.4881146199716677], [4, -0.590290826836843], [5, 21.230051448181193],
    [6, 15.279233632882423], [7, -33.28821096898486], [8, -0.020331201708508627],
  ],
  [
    [0, -0.9371424300859873], [3, 5.186372428844064], [4, 1.0914373489967295], [5, -8.149787010746927],
    [6, -18.52006565999696], [7, 22.739487099350505], [8, 2.4936055526796523], [9, -3.0467644718982196],
  ],
  [
    [0, 2.273310147516538], [3, -10.53449546673725], [4, -2.0008720582248625], [5, -17.9589318631188],
    [6, 27.94888452941996], [7, -2.8589982771350235], [8, -8.87285693353063], [9, 12.360567175794303],
    [10, 0.6433927460157636],
  ],
  [],
  [
    [0, 0.056167502283047954], [6, 0.25350021021662483], [7, -0.2462390374708025], [8, -0.12419142326381637],
    [9, 0.15329179827876568], [10, 0.00820105229563469], [11, 0.007567897660545699], [12, -0.008298],
  ],
  [
    [0, 0.03183464816350214], [5, 0.028300909672366776], [6, 0.053541988307438566], [7, -0.05492374857139099],
    [10, -0.00010834732869724932], [11, 0.0003825710908356584], [12, -0.00034046500868740456],
    [13, 0.1413124436746325],
  ],
  [
    [0, -0.42889630158379194], [5, -4.697621415361164], [6, 7.683421196062599], [7, 4.06898981839711],
    [8, 0.3567271874552811], [12, -0.0013990241651590145], [13, 2.9475147891527724], [14, -9.15095847217987],
  ],
];

/** Weights of the end of the step. */
const B = [
  [0, 0.054293734116568765], [5, 4.450312892752409], [6, 1.8915178993145003], [7, -5.801203960010585],
  [8, 0.3111643669578199], [9, -0.1521609496625161], [10, 0.20136540080403034], [11, 0.04471061572777259],
];

/** Weights of the embedded formula of order 3. */
const B_HAT_3 = [
  [0, 0.2440944881889764], [8, 0.7338466882816118], [11, 0.022058823529411766],
];

/** `b` less the weights of the embedded formula of order 5. */
const E5 = [
  [0, 0.01312004499419488], [5, -1.2251564463762044], [6, -0.4957589496572502], [7, 1.6643771824549864],
  [8, -0.35032884874997366], [9, 0.3341791187130175], [10, 0.08192320648511571], [11, -0.022355307863886294],
];

/** `b` less the weights of the embedded formula of order 3. */
const E3 = B.map(([stage, weight]) => [stage, weight - (B_HAT_3.find(([other]) => other === stage)?.[1] ?? 0)]);

/** Parts r4 to r7 of the dense output. */
const D = [
  [
    [0, -8.428938276109013], [5, 0.5667149535193777], [6, -3.0689499459498917], [7, 2.38466765651207],
    [8, 2.117034582445028], [9, -0.871391583777973], [10, 2.2404374302607883], [11, 0.6315787787694688],
    [12, -0.08899033645133331], [13, 18.148505520854727], [14, -9.194632392478356], [15, -4.436036387594894],
  ],
  [
    [0, 10.427508642579134], [5, 242.28349177525817], [6, 165.20045171727028], [7, -374.5467547226902],
    [8, -22.113666853125306], [9, 7.733432668472264], [10, -30.674084731089398], [11, -9.332130526430229],
    [12, 15.697238121770845], [13, -31.139403219565178], [14, -9.35292435884448], [15, 35.81684148639408],
  ],
  [
    [0, 19.985053242002433], [5, -387.0373087493518], [6, -189.17813819516758], [7, 527.8081592054236],
    [8, -11.57390253995963], [9, 6.8812326946963], [10, -1.0006050966910838], [11, 0.7777137798053443],
    [12, -2.778205752353508], [13, -60.19669523126412], [14, 84.32040550667716], [15, 11.99229113618279],
  ],
  [
    [0, -25.69393346270375], [5, -154.18974869023643], [6, -231.5293791760455], [7, 357.6391179106141],
    [8, 93.40532418362432], [9, -37.45832313645163], [10, 104.0996495089623], [11, 29.8402934266605],
    [12, -43.53345659001114], [13, 96.32455395918828], [14, -39.17726167561544], [15, -149.72683625798564],
  ],
];

const END = 12;
const EPSILON = Number.EPSILON;

const isFinite = (values) => values.every((x) => Math.abs(x) < Infinity);
const zeros = (n) => new Array(n).fill(0);

/** `Σ weight · slope` of the number `i`. */
function weighted(row, slopes, i) {
  let sum = row[0][1] * slopes[row[0][0]][i];
  for (let k = 1; k < row.length; k++) sum = sum + row[k][1] * slopes[row[k][0]][i];
  return sum;
}

/** `base + Σ (h weight) · slope` */
function combine(out, base, h, row, slopes) {
  for (let i = 0; i < out.length; i++) {
    let sum = h * row[0][1] * slopes[row[0][0]][i];
    for (let k = 1; k < row.length; k++) sum = sum + h * row[k][1] * slopes[row[k][0]][i];
    out[i] = base[i] + sum;
  }
}

/** Steps with error control along `q̈ = acceleration(t, q, q̇)`. */
export class Dop853 {
  constructor(acceleration, t, q, qd, { rtol = 1e-10, atol = 1e-12, longest = Infinity, mostSteps = 50_000 } = {}) {
    const n = q.length;
    Object.assign(this, { acceleration, t, rtol, atol, longest, mostSteps, known: false });
    Object.assign(this, { q: Array.from(q), qd: Array.from(qd) });
    this.v = Array.from({ length: 16 }, () => zeros(n));
    this.a = Array.from({ length: 16 }, () => zeros(n));
    this.parts = null;
    this.length = null;
    this.summary = { accepted: 0, rejected: 0, evaluations: 0 };
  }

  /** Whether the acceleration is a number; it becomes slope `s`. */
  evaluate(t, q, s) {
    this.summary.evaluations += 1;
    const found = this.acceleration(t, q, this.v[s]);
    if (!isFinite(found)) return false;
    this.a[s] = found;
    return true;
  }

  stage(s, t, h, old) {
    const q = zeros(old.q.length);
    combine(q, old.q, h, A[s], this.v);
    combine(this.v[s], old.qd, h, A[s], this.a);
    return this.evaluate(t + NODES[s] * h, q, s);
  }

  /** Root mean square in units of the tolerance. */
  norm(x, y) {
    let sum = 0;
    for (const [at, values] of [[this.q, x], [this.qd, y]]) {
      for (let i = 0; i < at.length; i++) {
        const scaled = values[i] / (this.atol + this.rtol * Math.abs(at[i]));
        sum = sum + scaled * scaled;
      }
    }
    return Math.sqrt(sum / Math.max(1, 2 * x.length));
  }

  /** Hairer's choice of the first step. */
  firstStep(longest) {
    const [d0, d1] = [this.norm(this.q, this.qd), this.norm(this.v[0], this.a[0])];
    const guess = Math.min(d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * (d0 / d1), longest);
    const q = zeros(this.q.length);
    combine(q, this.q, guess, [[0, 1]], this.v);
    combine(this.v[1], this.qd, guess, [[0, 1]], this.a);
    if (!this.evaluate(this.t + guess, q, 1)) return guess;
    const rise = (slopes) => slopes[1].map((x, i) => x - slopes[0][i]);
    const d2 = this.norm(rise(this.v), rise(this.a)) / guess;
    const steepest = d1 > d2 ? d1 : d2;
    const step = steepest <= 1e-15 ? Math.max(guess * 1e-3, 1e-6) : Math.pow(0.01 / steepest, 1 / 8);
    return Math.min(step, 100 * guess, longest);
  }

  factor(error) {
    if (!(Math.abs(error) < Infinity)) return 1 / 3;
    const longer = 0.9 * (1 / Math.sqrt(Math.sqrt(Math.sqrt(error))));
    return Math.min(6, Math.max(1 / 3, longer));
  }

  /** The error of the step, or null where something is not a number. */
  advance(t, h, old) {
    for (let s = 1; s < END; s++) if (!this.stage(s, t, h, old)) return null;
    const now = { q: zeros(old.q.length), qd: zeros(old.q.length) };
    combine(now.q, old.q, h, B, this.v);
    combine(now.qd, old.qd, h, B, this.a);
    let [fifth, third] = [0, 0];
    for (const [slopes, y0, y1] of [[this.v, old.q, now.q], [this.a, old.qd, now.qd]]) {
      for (let i = 0; i < y0.length; i++) {
        const perScale = 1 / (this.atol + this.rtol * Math.max(Math.abs(y0[i]), Math.abs(y1[i])));
        const [five, three] = [weighted(E5, slopes, i) * perScale, weighted(E3, slopes, i) * perScale];
        fifth = fifth + five * five;
        third = third + three * three;
      }
    }
    const damped = fifth + 0.01 * third;
    const error = damped === 0 ? damped : (Math.abs(h) * fifth) / Math.sqrt(damped * (2 * old.q.length));
    if (!isFinite(now.q) || !isFinite(now.qd)) return null;
    if (error <= 1) {
      this.v[END] = now.qd.slice();
      if (!this.evaluate(t + h, now.q, END)) return null;
    }
    this.next = now;
    return error;
  }

  /** One accepted step towards `end`. Throws where there is no way on. */
  step(end) {
    if (this.known) {
      [this.v[0], this.v[END]] = [this.v[END], this.v[0]];
      [this.a[0], this.a[END]] = [this.a[END], this.a[0]];
    } else {
      this.v[0] = this.qd.slice();
      if (!this.evaluate(this.t, this.q, 0)) throw new Error(`there is no finite acceleration at t = ${this.t} s`);
    }
    this.length ??= this.firstStep(Math.min(Math.abs(end - this.t), this.longest));
    const old = { q: this.q, qd: this.qd };
    let rejected = false;
    for (;;) {
      const { accepted, rejected: refused } = this.summary;
      if (accepted + refused >= this.mostSteps) throw new Error(`${this.mostSteps} steps lead to t = ${this.t} s only`);
      const shortest = Math.max(16 * EPSILON * Math.abs(this.t), 2.2250738585072014e-308);
      const length = Math.max(Math.min(this.length, this.longest), shortest);
      const remaining = Math.abs(end - this.t);
      const isLast = 1.01 * length >= remaining && remaining <= (1 + 1e-9) * this.longest;
      const stop = isLast ? end : this.t + length;
      const taken = isLast ? remaining : length;
      const error = this.advance(this.t, stop - this.t, old);
      if (error === null || !(error <= 1)) {
        if (taken <= shortest) throw new Error(`there is no way on from t = ${this.t} s`);
        this.summary.rejected += 1;
        rejected = true;
        this.length = taken * Math.min(error === null ? 1 / 3 : this.factor(error), 0.9);
        continue;
      }
      const factor = this.factor(error);
      const proposed = taken * (rejected ? Math.min(factor, 1) : factor);
      this.length = isLast ? Math.max(proposed, length) : proposed;
      this.summary.accepted += 1;
      this.span = { start: this.t, end: stop, old, now: this.next };
      Object.assign(this, { t: stop, q: this.next.q, qd: this.next.qd, known: true, parts: null });
      return;
    }
  }

  /** Goes on from another state at the end of the last step. */
  replace(q, qd) {
    this.q = Array.from(q);
    this.qd = Array.from(qd);
    this.known = false;
  }

  /** The state at a time within the last step. */
  interpolate(t) {
    const { start, end, old, now } = this.span;
    if (t === end) return { q: now.q.slice(), qd: now.qd.slice() };
    if (t === start) return { q: old.q.slice(), qd: old.qd.slice() };
    const h = end - start;
    this.parts ??= this.prepare(start, h, old, now);
    const theta = (t - start) / h;
    const rest = 1 - theta;
    const at = (y0, parts) =>
      y0.map((y, i) => {
        const r = (k) => parts[k][i];
        const inner = r(3) + theta * (r(4) + rest * (r(5) + theta * r(6)));
        return y + theta * (r(0) + rest * (r(1) + theta * (r(2) + rest * inner)));
      });
    return { q: at(old.q, this.parts[0]), qd: at(old.qd, this.parts[1]) };
  }

  prepare(start, h, old, now) {
    for (let s = 13; s < 16; s++) {
      if (!this.stage(s, start, h, old)) throw new Error(`there is no finite acceleration at t = ${start} s`);
    }
    const parts = (slopes, y0, y1) => {
      const rise = y1.map((y, i) => y - y0[i]);
      const first = rise.map((x, i) => h * slopes[0][i] - x);
      const third = rise.map((x, i) => x - h * slopes[END][i] - first[i]);
      return [rise, first, third, ...D.map((row) => rise.map((_, i) => h * weighted(row, slopes, i)))];
    };
    return [parts(this.v, old.q, now.q), parts(this.a, old.qd, now.qd)];
  }
}
