// Curves over time on a canvas.

const COLOURS = ["#2f7fd0", "#e06c34", "#2ba05a", "#b64fc0", "#c9a227", "#d1495b", "#26a5a5", "#7a6ff0", "#7d8a3a", "#9b6a4f"];
const MARGIN = { left: 58, right: 12, top: 22, bottom: 24 };

/** 1, 2 or 5 times a power of ten: about this many intervals. */
function step(span, intervals) {
  const raw = span / intervals;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
}

function ticks(low, high, intervals) {
  let width = step(high - low || 1, intervals);
  const few = (width) => Math.floor(high / width) - Math.ceil(low / width) < 2;
  for (let more = intervals + 1; few(width) && more < 12; more++) width = step(high - low || 1, more);
  const count = Math.floor(high / width + 1e-9) - Math.ceil(low / width - 1e-9) + 1;
  return Array.from({ length: Math.max(0, count) }, (_, i) => (Math.ceil(low / width - 1e-9) + i) * width);
}

/** As few digits as tell neighbours apart. */
export function number(x, digits = 4) {
  if (x === 0) return "0";
  const text = Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(digits - 1) : x.toPrecision(digits);
  return text.replace(/(\.\d*?)0+(?=e|$)/, "$1").replace(/\.(?=e|$)/, "").replace("-", "−").replace("e+", "e");
}

/** A panel of curves of one unit. */
export class Plot {
  constructor(parent) {
    this.root = document.createElement("div");
    this.root.className = "plot";
    this.canvas = document.createElement("canvas");
    this.legend = document.createElement("div");
    this.legend.className = "legend";
    this.root.append(this.canvas, this.legend);
    parent.append(this.root);
    this.canvas.addEventListener("pointermove", (event) => this.point(event.offsetX));
    this.canvas.addEventListener("pointerleave", () => this.point(null));
    new ResizeObserver(() => this.draw()).observe(this.root);
  }

  /** Curves `{ name, values }` over `t`. */
  show({ title, t, curves, height }) {
    Object.assign(this, { title, t, curves, height, at: null });
    this.legend.replaceChildren(
      ...curves.map(({ name }, i) => {
        const entry = document.createElement("span");
        const [dash, value] = [document.createElement("i"), document.createElement("b")];
        dash.style.background = COLOURS[i % COLOURS.length];
        entry.append(dash, name, " ", value);
        return entry;
      }),
    );
    this.draw();
  }

  /** Shows the values at a place of the canvas. */
  point(x) {
    if (!this.t) return;
    const time = x === null ? null : this.t[0] + ((x - MARGIN.left) / this.width) * (this.t.at(-1) - this.t[0]);
    const i = time === null ? -1 : this.t.findIndex((t) => t >= time);
    this.at = x === null || i < 0 || x < MARGIN.left ? null : i;
    this.legend.querySelectorAll("b").forEach((value, k) => {
      value.textContent = this.at === null ? "" : number(this.curves[k].values[this.at], 5);
    });
    this.draw();
  }

  draw() {
    if (!this.t || this.root.clientWidth === 0) return;
    const [full, high, ratio] = [this.root.clientWidth, this.height, devicePixelRatio || 1];
    this.canvas.style.height = `${high}px`;
    this.canvas.width = Math.round(full * ratio);
    this.canvas.height = Math.round(high * ratio);
    const g = this.canvas.getContext("2d");
    g.scale(ratio, ratio);
    const style = getComputedStyle(this.root);
    const colour = (name) => style.getPropertyValue(name) || style.color;
    const ink = style.color;
    this.width = full - MARGIN.left - MARGIN.right;
    const inner = high - MARGIN.top - MARGIN.bottom;
    const [t0, t1] = [this.t[0], this.t.at(-1)];
    let [low, up] = [Infinity, -Infinity];
    for (const { values } of this.curves) for (const y of values) [low, up] = [Math.min(low, y), Math.max(up, y)];
    const room = (up - low) * 0.06 || Math.abs(up) * 1e-3 || 1;
    [low, up] = [low - room, up + room];
    const x = (t) => MARGIN.left + ((t - t0) / (t1 - t0 || 1)) * this.width;
    const y = (value) => MARGIN.top + (1 - (value - low) / (up - low)) * inner;

    g.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    g.lineWidth = 1;
    g.fillStyle = ink;
    const vertical = ticks(low, up, Math.max(2, Math.round(inner / 42)));
    const digits = Math.max(3, Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(up)) / (vertical[1] - vertical[0] || 1))) + 1);
    const line = (x0, y0, x1, y1) => {
      g.beginPath();
      g.moveTo(x0, y0);
      g.lineTo(x1, y1);
      g.stroke();
    };
    g.textBaseline = "middle";
    g.textAlign = "right";
    for (const value of vertical) {
      g.strokeStyle = ink;
      g.globalAlpha = Math.abs(value) < 1e-12 * (up - low) ? 0.4 : 0.1;
      line(MARGIN.left, Math.round(y(value)) + 0.5, full - MARGIN.right, Math.round(y(value)) + 0.5);
      g.globalAlpha = 0.65;
      g.fillText(number(Math.abs(value) < 1e-12 * (up - low) ? 0 : value, Math.min(digits, 7)), MARGIN.left - 6, y(value));
    }
    g.textBaseline = "top";
    g.textAlign = "center";
    for (const value of ticks(t0, t1, Math.max(2, Math.round(this.width / 90)))) {
      g.globalAlpha = 0.1;
      line(Math.round(x(value)) + 0.5, MARGIN.top, Math.round(x(value)) + 0.5, high - MARGIN.bottom);
      g.globalAlpha = 0.65;
      g.fillText(number(value, 6), x(value), high - MARGIN.bottom + 6);
    }
    g.textAlign = "left";
    g.globalAlpha = 1;
    g.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
    g.fillText(this.title, MARGIN.left, 3);
    g.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    g.textAlign = "right";
    g.globalAlpha = 0.65;
    g.fillText("t / s", full - MARGIN.right, 4);
    g.globalAlpha = 1;

    g.lineWidth = 1.6;
    g.lineJoin = "round";
    this.curves.forEach(({ values }, i) => {
      g.strokeStyle = COLOURS[i % COLOURS.length];
      g.beginPath();
      values.forEach((value, k) => (k === 0 ? g.moveTo(x(this.t[k]), y(value)) : g.lineTo(x(this.t[k]), y(value))));
      g.stroke();
    });
    if (this.at === null) return;
    g.strokeStyle = colour("--faint");
    g.lineWidth = 1;
    line(x(this.t[this.at]), MARGIN.top, x(this.t[this.at]), high - MARGIN.bottom);
    g.textAlign = this.at > this.t.length / 2 ? "right" : "left";
    g.fillStyle = colour("--faint");
    g.fillText(`${number(this.t[this.at], 5)} s`, x(this.t[this.at]) + (g.textAlign === "left" ? 5 : -5), MARGIN.top + 3);
  }
}

/** The path of a point, seen along the axis in which it moves least; both scales are the same. */
export class Path {
  constructor(parent) {
    this.root = document.createElement("div");
    this.root.className = "plot";
    this.canvas = document.createElement("canvas");
    this.root.append(this.canvas);
    parent.append(this.root);
    new ResizeObserver(() => this.draw()).observe(this.root);
  }

  /** A point whose coordinates are three lists of numbers. */
  show({ title, unit, axes, height }) {
    const spans = axes.map((values) => {
      const [low, up] = values.reduce(([low, up], x) => [Math.min(low, x), Math.max(up, x)], [Infinity, -Infinity]);
      return { low, span: up - low };
    });
    const least = spans.map(({ span }) => span).reduce((least, span, i, all) => (span < all[least] ? i : least), 0);
    const seen = [0, 1, 2].filter((axis) => axis !== least);
    Object.assign(this, { title, unit, height, seen, curves: seen.map((axis) => axes[axis]), spans: seen.map((axis) => spans[axis]) });
    this.draw();
  }

  draw() {
    if (!this.curves || this.root.clientWidth === 0) return;
    const [full, high, ratio] = [this.root.clientWidth, this.height, devicePixelRatio || 1];
    this.canvas.style.height = `${high}px`;
    this.canvas.width = Math.round(full * ratio);
    this.canvas.height = Math.round(high * ratio);
    const g = this.canvas.getContext("2d");
    g.scale(ratio, ratio);
    g.strokeStyle = g.fillStyle = getComputedStyle(this.root).color;
    const [width, inner] = [full - MARGIN.left - MARGIN.right, high - MARGIN.top - MARGIN.bottom];
    const scale = 0.94 * Math.min(width / (this.spans[0].span || 1e-9), inner / (this.spans[1].span || 1e-9));
    const middle = this.spans.map(({ low, span }) => low + span / 2);
    const x = (value) => MARGIN.left + width / 2 + scale * (value - middle[0]);
    const y = (value) => MARGIN.top + inner / 2 - scale * (value - middle[1]);
    g.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
    g.textBaseline = "top";
    g.fillText(`${this.title}: ${"xyz"[this.seen[1]]} over ${"xyz"[this.seen[0]]}`, MARGIN.left, 3);

    // A bar tells the scale.
    const bar = step(width / scale / 5, 1);
    g.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    g.globalAlpha = 0.65;
    g.fillRect(full - MARGIN.right - bar * scale, high - MARGIN.bottom + 10, bar * scale, 2);
    g.textAlign = "right";
    g.fillText(`${number(bar)} ${this.unit}`, full - MARGIN.right - bar * scale - 8, high - MARGIN.bottom + 5);
    g.globalAlpha = 1;

    const [a, b] = this.curves;
    g.strokeStyle = COLOURS[2];
    g.lineWidth = 1.2;
    g.globalAlpha = 0.85;
    g.beginPath();
    a.forEach((value, k) => (k === 0 ? g.moveTo(x(value), y(b[k])) : g.lineTo(x(value), y(b[k]))));
    g.stroke();
    g.globalAlpha = 1;
    const dot = (k, colour) => {
      g.fillStyle = colour;
      g.beginPath();
      g.arc(x(a[k]), y(b[k]), 4, 0, 2 * Math.PI);
      g.fill();
    };
    dot(0, COLOURS[8]);
    dot(a.length - 1, COLOURS[1]);
  }
}
