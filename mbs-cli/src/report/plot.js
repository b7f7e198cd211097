// Curves on a canvas: over time, and one over the other.

/** Told apart by people who see fewer colours, on light and on dark paper (after P. Tol, *Colour schemes*, 2021). */
export const COLOURS = ["#4477aa", "#ee6677", "#228833", "#aa8811", "#3399bb", "#aa3377", "#88888c", "#ee8866", "#44aa99", "#8866cc"];
const MARGIN = { left: 62, right: 14, top: 24, bottom: 26 };
const FONT = "system-ui, 'DejaVu Sans', sans-serif";

/** As much of a text as is no wider than this. */
function fitting(g, text, width) {
  let shown = text;
  while (shown.length > 1 && g.measureText(shown).width > width) shown = `${shown.slice(0, -2)}…`;
  return shown;
}

/** 1, 2 or 5 times a power of ten: about this many intervals. */
function step(span, intervals) {
  const raw = span / intervals;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
}

function ticks(low, high, intervals) {
  const span = high - low || 1;
  const counted = (width) => Math.floor(high / width + 1e-9) - Math.ceil(low / width - 1e-9) + 1;
  let width = step(span, intervals);
  for (let more = intervals + 1; counted(width) < 3 && more < 12; more++) width = step(span, more);
  return Array.from({ length: Math.max(0, counted(width)) }, (_, i) => (Math.ceil(low / width - 1e-9) + i) * width);
}

/** As few digits as tell neighbours apart. */
export function number(x, digits = 4) {
  if (x === 0) return "0";
  if (!Number.isFinite(x)) return Number.isNaN(x) ? "NaN" : x > 0 ? "∞" : "−∞";
  const text = Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(digits - 1) : x.toPrecision(digits);
  return text.replace(/(\.\d*?)0+(?=e|$)/, "$1").replace(/\.(?=e|$)/, "").replace(/-/g, "−").replace("e+", "e");
}

function digitsOf(places, low, high) {
  const interval = places[1] - places[0] || 1;
  return Math.min(7, Math.max(3, Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / interval)) + 1));
}

/** The least and the greatest of finite numbers, with room around them. */
function range(lists, room = 0.06) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of lists) {
    for (const x of values) {
      if (!Number.isFinite(x)) continue;
      if (x < low) low = x;
      if (x > high) high = x;
    }
  }
  if (low > high) return [-1, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  // What differs by rounding alone is one number.
  const span = high - low > 1e-12 * size ? high - low : 0;
  const around = span * room || size * 1e-3 || 1;
  return [low - around, high + around];
}

/** A canvas of its own, as wide as its place, drawn anew when that changes. */
class Panel {
  constructor(parent, label) {
    this.root = document.createElement("div");
    this.root.className = "plot";
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    // What moves is an element above the curves: these are drawn again only where they change.
    this.marker = document.createElement("div");
    this.marker.hidden = true;
    const above = { position: "absolute", top: "0", left: "0", pointerEvents: "none", willChange: "transform" };
    Object.assign(this.marker.style, above);
    this.root.append(this.canvas, this.marker);
    parent.append(this.root);
    new ResizeObserver(() => this.draw()).observe(this.root);
  }

  /** A clean canvas with its scale set, or undefined while it is not seen. */
  begin() {
    if (this.height === undefined || this.root.clientWidth === 0) return undefined;
    const [full, ratio] = [this.root.clientWidth, devicePixelRatio || 1];
    this.full = full;
    this.canvas.style.height = `${this.height}px`;
    this.canvas.width = Math.round(full * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    const g = this.canvas.getContext("2d");
    g.scale(ratio, ratio);
    g.fillStyle = g.strokeStyle = this.ink = getComputedStyle(this.root).color;
    this.width = full - MARGIN.left - MARGIN.right;
    this.inner = this.height - MARGIN.top - MARGIN.bottom;
    return g;
  }

  axes(g, [left, right], [low, high], title, name) {
    this.x = (value) => MARGIN.left + ((value - left) / (right - left || 1)) * this.width;
    this.y = (value) => MARGIN.top + (1 - (value - low) / (high - low || 1)) * this.inner;
    const [x, y, bottom] = [this.x, this.y, this.height - MARGIN.bottom];
    g.font = `11px ${FONT}`;
    g.lineWidth = 1;
    const line = (x0, y0, x1, y1, alpha) => {
      g.globalAlpha = alpha;
      g.beginPath();
      g.moveTo(x0, y0);
      g.lineTo(x1, y1);
      g.stroke();
      g.globalAlpha = 0.75;
    };
    const isZero = (value, [from, to]) => Math.abs(value) < 1e-12 * (to - from);
    const vertical = ticks(low, high, Math.max(2, Math.round(this.inner / 42)));
    [g.textBaseline, g.textAlign] = ["middle", "right"];
    for (const value of vertical) {
      const zero = isZero(value, [low, high]);
      line(MARGIN.left, Math.round(y(value)) + 0.5, this.full - MARGIN.right, Math.round(y(value)) + 0.5, zero ? 0.4 : 0.1);
      g.fillText(number(zero ? 0 : value, digitsOf(vertical, low, high)), MARGIN.left - 6, y(value));
    }
    const horizontal = ticks(left, right, Math.max(2, Math.round(this.width / 90)));
    [g.textBaseline, g.textAlign] = ["top", "center"];
    for (const value of horizontal) {
      const zero = isZero(value, [left, right]);
      line(Math.round(x(value)) + 0.5, MARGIN.top, Math.round(x(value)) + 0.5, bottom, zero ? 0.4 : 0.1);
      g.fillText(number(zero ? 0 : value, digitsOf(horizontal, left, right)), x(value), bottom + 6);
    }
    [g.textAlign, g.globalAlpha] = ["left", 1];
    g.font = `600 12px ${FONT}`;
    g.fillText(fitting(g, title, this.width - g.measureText(name).width - 12), MARGIN.left, 4);
    g.font = `11px ${FONT}`;
    [g.textAlign, g.globalAlpha] = ["right", 0.75];
    g.fillText(name, this.full - MARGIN.right, 5);
    g.globalAlpha = 1;
  }

  curve(g, xs, ys, colour) {
    [g.strokeStyle, g.lineWidth, g.lineJoin] = [colour, 1.6, "round"];
    g.beginPath();
    let down = false;
    for (let k = 0; k < ys.length; k++) {
      const [x, y] = [this.x(xs[k]), this.y(ys[k])];
      if (!Number.isFinite(y) || !Number.isFinite(x)) down = false;
      else if (down) g.lineTo(x, y);
      else {
        g.moveTo(x, y);
        down = true;
      }
    }
    g.stroke();
  }

  /** Puts the marker's upper left corner there; away without a place. */
  put(x, y) {
    this.marker.hidden = !(Number.isFinite(x) && Number.isFinite(y));
    if (!this.marker.hidden) this.marker.style.transform = `translate(${x}px, ${y}px)`;
  }
}

/** Curves of one unit over time, with a line at a time. */
export class Plot extends Panel {
  /** `scrub` is told the times that are pointed at with a pressed button; without it pointing shows values. */
  constructor(parent, scrub = undefined) {
    super(parent, "curves over time");
    this.legend = document.createElement("div");
    this.legend.className = "legend";
    this.root.append(this.legend);
    Object.assign(this.marker.style, { width: "1px", background: "currentColor", opacity: "0.5" });
    const time = (event) => {
      const [from, to] = this.span;
      const t = from + ((event.offsetX - MARGIN.left) / this.width) * (to - from);
      return Math.min(to, Math.max(from, t));
    };
    this.canvas.addEventListener("pointermove", (event) => {
      if (!this.t) return;
      if (scrub === undefined) this.mark(event.offsetX < MARGIN.left ? null : time(event));
      else if (event.buttons & 1) scrub(time(event));
    });
    this.canvas.addEventListener("pointerdown", (event) => this.t && scrub?.(time(event)));
    if (scrub === undefined) this.canvas.addEventListener("pointerleave", () => this.mark(null));
  }

  /** Curves `{ name, values }` over `t`; the axis goes to `end`. */
  show({ title, t, curves, height, end = t.at(-1) }) {
    Object.assign(this, { title, t, curves, height, span: [t[0], end] });
    this.limits = range(curves.map(({ values }) => values));
    this.legend.replaceChildren(
      ...curves.map(({ name }, i) => {
        const entry = document.createElement("span");
        const [dash, value] = [document.createElement("i"), document.createElement("b")];
        dash.style.background = COLOURS[i % COLOURS.length];
        entry.append(dash, name, " ", value);
        return entry;
      }),
    );
    this.values = Array.from(this.legend.querySelectorAll("b"));
    this.draw();
    this.mark(this.at ?? null);
  }

  /** A line at this time, and the values there; none for null. */
  mark(t) {
    this.at = t;
    if (!this.t) return;
    const i = t === null ? -1 : this.t.findIndex((other) => other >= t);
    this.values.forEach((value, k) => {
      value.textContent = i < 0 ? "" : number(this.curves[k].values[i], 5);
    });
    this.place();
  }

  place() {
    if (this.x === undefined) return;
    this.marker.style.height = `${this.inner}px`;
    this.put(this.at === null ? NaN : this.x(this.at), MARGIN.top);
  }

  draw() {
    const g = this.t && this.begin();
    if (!g) return;
    this.axes(g, this.span, this.limits, this.title, "t / s");
    this.curves.forEach(({ values }, i) => this.curve(g, this.t, values, COLOURS[i % COLOURS.length]));
    this.place();
  }
}

/** One quantity over another. */
export class Phase extends Panel {
  constructor(parent) {
    super(parent, "one quantity over another");
    Object.assign(this.marker.style, { width: "8px", height: "8px", borderRadius: "4px", background: COLOURS[1] });
  }

  /** `x` and `y` are `{ name, unit, values }`; `equal` scales show shapes as they are. */
  show({ title, x, y, height, equal = false }) {
    Object.assign(this, { title, xs: x.values, ys: y.values, height, equal });
    const of = ({ name, unit }) => (unit === "1" || !unit ? name : `${name} / ${unit}`);
    [this.across, this.title] = [of(x), title ?? `${of(y)} over ${of(x)}`];
    this.ranges = [range([x.values]), range([y.values])];
    this.draw();
  }

  /** A dot at these values; none without. */
  mark(point) {
    this.point = point;
    this.place();
  }

  place() {
    if (this.x === undefined) return;
    const last = this.xs.length - 1;
    const [x, y] = this.point ?? [this.xs[last], this.ys[last]];
    this.put(this.x(x) - 4, this.y(y) - 4);
  }

  draw() {
    const g = this.xs && this.begin();
    if (!g) return;
    let [horizontal, vertical] = this.ranges;
    if (this.equal) {
      const per = Math.max((horizontal[1] - horizontal[0]) / this.width, (vertical[1] - vertical[0]) / this.inner);
      const around = ([low, high], pixels) => [(low + high - per * pixels) / 2, (low + high + per * pixels) / 2];
      [horizontal, vertical] = [around(horizontal, this.width), around(vertical, this.inner)];
    }
    this.axes(g, horizontal, vertical, this.title, this.across);
    this.curve(g, this.xs, this.ys, COLOURS[0]);
    this.place();
  }
}
