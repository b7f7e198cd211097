// The picture: plain WebGL, one shader for solids and one for lines. Axes are those of the world, z is up.

import { add, between, cross, dot, identity, length, lookAt, multiply, perspective, pose, scale, sub, unit } from "./solid.js";

const SOLID = `
  attribute vec3 place; attribute vec3 normal;
  uniform mat4 model; uniform mat4 lens; uniform vec3 flatten;
  varying vec3 n; varying vec3 p;
  void main() {
    vec4 at = model * vec4(place, 1.0);
    n = normalize(mat3(model[0].xyz / flatten.x, model[1].xyz / flatten.y, model[2].xyz / flatten.z) * normal);
    p = at.xyz;
    gl_Position = lens * at;
  }`;
const SHADED = `
  precision mediump float;
  uniform vec4 colour; uniform float glow; varying vec3 n; varying vec3 p;
  void main() {
    vec3 up = normalize(n);
    if (dot(up, p) > 0.0) up = -up;
    float key = max(dot(up, normalize(vec3(0.35, 0.7, 0.6))), 0.0);
    float back = max(dot(up, normalize(vec3(-0.6, -0.1, 0.4))), 0.0);
    float light = mix(0.56 + 0.42 * key + 0.12 * back, 1.0, glow);
    gl_FragColor = vec4(colour.rgb * light, colour.a);
  }`;
const LINE = `
  attribute vec3 place; attribute float age; uniform mat4 both; varying float a;
  void main() { a = age; gl_Position = both * vec4(place, 1.0); }`;
const PLAIN = `
  precision mediump float; uniform vec4 colour; varying float a;
  void main() { gl_FragColor = vec4(colour.rgb, colour.a * a); }`;

const ANGLE = 0.6;

/** Triangles of a unit sphere: places and normals are the same. */
function sphere(rings, sectors) {
  const at = (i, j) => {
    const [latitude, longitude] = [Math.PI * (i / rings), 2 * Math.PI * (j / sectors)];
    const across = Math.sin(latitude);
    return [across * Math.cos(longitude), across * Math.sin(longitude), Math.cos(latitude)];
  };
  const numbers = [];
  const put = (...places) => places.forEach((place) => numbers.push(...place, ...place));
  for (let i = 0; i < rings; i++) {
    for (let j = 0; j < sectors; j++) {
      const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
      if (i < rings - 1) put(a, b, c);
      if (i > 0) put(a, c, d);
    }
  }
  return numbers;
}

/** A cylinder of radius 1 from z = 0 to z = 1, with its ends. */
function cylinder(sectors) {
  const numbers = [];
  const at = (j) => [Math.cos((2 * Math.PI * j) / sectors), Math.sin((2 * Math.PI * j) / sectors)];
  for (let j = 0; j < sectors; j++) {
    const [[ax, ay], [bx, by]] = [at(j), at(j + 1)];
    for (const [x, y, z] of [[ax, ay, 0], [bx, by, 0], [bx, by, 1], [ax, ay, 0], [bx, by, 1], [ax, ay, 1]]) {
      numbers.push(x, y, z, x, y, 0);
    }
    for (const [z, up] of [[0, -1], [1, 1]]) numbers.push(0, 0, z, 0, 0, up, ax, ay, z, 0, 0, up, bx, by, z, 0, 0, up);
  }
  return numbers;
}

/** A box with edges of 2 about the origin. */
function box() {
  const numbers = [];
  for (let axis = 0; axis < 3; axis++) {
    for (const side of [-1, 1]) {
      const corner = (a, b) => {
        const place = [0, 0, 0];
        [place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]] = [side, a, b];
        return place;
      };
      const normal = [0, 0, 0];
      normal[axis] = side;
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) numbers.push(...corner(a, b), ...normal);
    }
  }
  return numbers;
}

/** `#rrggbb` or `rgb(…)` as numbers from 0 to 1. */
export function colour(text, alpha = 1) {
  const hex = /^#([0-9a-f]{6})$/i.exec(text.trim());
  const bytes = hex ? [0, 2, 4].map((i) => parseInt(hex[1].slice(i, i + 2), 16)) : (text.match(/[\d.]+/g) ?? [0, 0, 0]).slice(0, 3);
  return [...bytes.map((byte) => Number(byte) / 255), alpha];
}

/** Whether there is no graphics card, so that smooth edges would cost most of the time of a frame. */
function isDrawnByProcessor(gl) {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  return /swiftshader|llvmpipe|software/i.test(name);
}

/** Gives a canvas as many pixels as it has on the screen. */
function resize(canvas) {
  const ratio = Math.min(devicePixelRatio || 1, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((length) => Math.round(length * ratio));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
}

/** A canvas to draw on; in place of the given one, of which only one kind of picture can be had, if edges are smooth. */
function drawable(given) {
  // A context that exists is slow to resize: the first frame would wait for it.
  resize(given);
  const rough = given.getContext("webgl", { antialias: false, alpha: false });
  if (rough === null) throw new Error("this browser has no WebGL");
  if (isDrawnByProcessor(rough)) return { canvas: given, gl: rough };
  const canvas = given.cloneNode();
  const gl = canvas.getContext("webgl", { antialias: true, alpha: false });
  if (gl === null) return { canvas: given, gl: rough };
  given.replaceWith(canvas);
  rough.getExtension("WEBGL_lose_context")?.loseContext();
  return { canvas, gl };
}

/** A canvas with a camera that goes round a centre. */
export class View {
  /** Throws where there is no WebGL. */
  constructor(canvas) {
    Object.assign(this, drawable(canvas));
    const { gl } = this;
    this.solids = this.program(SOLID, SHADED, ["place", "normal"], ["model", "lens", "flatten", "colour", "glow"]);
    this.lines = this.program(LINE, PLAIN, ["place", "age"], ["both", "colour"]);
    const meshes = { sphere: sphere(20, 32), dot: sphere(8, 12), cylinder: cylinder(16), box: box() };
    this.meshes = Object.fromEntries(Object.entries(meshes).map(([name, numbers]) => [name, this.mesh(numbers)]));
    this.strip = gl.createBuffer();
    Object.assign(this, { centre: [0, 0, 0], radius: 1, azimuth: -1.1, elevation: 0.35, zoom: 1, touched: false });
    this.listen();
  }

  program(vertex, fragment, attributes, uniforms) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    attributes.forEach((name, i) => gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`WebGL: ${gl.getProgramInfoLog(program)}`);
    return { program, at: Object.fromEntries(uniforms.map((name) => [name, gl.getUniformLocation(program, name)])) };
  }

  mesh(numbers) {
    const { gl } = this;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
    return { buffer, count: numbers.length / 6 };
  }

  /** A mesh of triangles, each with its own normal: `[[a, b, c], …]`. */
  triangles(triangles) {
    const normal = ([a, b, c]) => unit(cross(sub(b, a), sub(c, a)));
    return this.mesh(triangles.flatMap((corners) => corners.flatMap((corner) => [...corner, ...normal(corners)])));
  }

  listen() {
    const { canvas } = this;
    const turn = (x, y) => {
      this.azimuth -= x;
      this.elevation = Math.min(1.55, Math.max(-1.55, this.elevation + y));
      this.touched = true;
      this.changed?.();
    };
    const nearer = (factor) => {
      this.zoom = Math.min(8, Math.max(0.15, this.zoom * factor));
      this.touched = true;
      this.changed?.();
    };
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (!(event.buttons & 3)) return;
      if (event.buttons & 2 || event.shiftKey) this.shift(event.movementX, event.movementY);
      else turn(event.movementX * 0.008, event.movementY * 0.008);
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      // A page with a picture on it is scrolled past the picture: zoom takes a key, as on maps.
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      nearer(Math.exp(event.deltaY * 0.002));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const keys = {
        ArrowLeft: () => turn(0.08, 0),
        ArrowRight: () => turn(-0.08, 0),
        ArrowUp: () => turn(0, 0.08),
        ArrowDown: () => turn(0, -0.08),
        "+": () => nearer(0.9),
        "=": () => nearer(0.9),
        "-": () => nearer(1.1),
      };
      if (!(event.key in keys)) return;
      event.preventDefault();
      event.stopPropagation();
      keys[event.key]();
    });
  }

  shift(x, y) {
    const { right, above } = this.camera();
    const per = (2 * this.distance() * Math.tan(ANGLE / 2)) / this.canvas.clientHeight;
    this.centre = add(this.centre, add(scale(right, -x * per), scale(above, y * per)));
    this.touched = true;
    this.changed?.();
  }

  /** Looks at all of these places: from the side on which they lie in a plane, else from aside and above. */
  fit(places) {
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const place of places) {
      for (let i = 0; i < 3; i++) {
        if (!Number.isFinite(place[i])) continue;
        low[i] = Math.min(low[i], place[i]);
        high[i] = Math.max(high[i], place[i]);
      }
    }
    if (!(low[0] <= high[0])) return;
    const spans = high.map((x, i) => x - low[i]);
    this.centre = low.map((x, i) => (x + high[i]) / 2);
    this.radius = length(spans) / 2 || 1;
    if (!this.touched) this.turnTo(spans);
    this.reach = this.needed(places);
  }

  turnTo(spans) {
    const flat = 0.02 * Math.max(...spans);
    if (spans[1] <= flat && spans[2] > flat) [this.azimuth, this.elevation] = [-Math.PI / 2 + 0.25, 0.18];
    else if (spans[2] <= flat && spans[0] > flat) [this.azimuth, this.elevation] = [-Math.PI / 2 + 0.2, 1.0];
    else if (spans[0] <= flat && spans[2] > flat) [this.azimuth, this.elevation] = [0.25, 0.18];
    else [this.azimuth, this.elevation] = [-1.0, 0.4];
  }

  /** How far away all of these places are seen. */
  needed(places) {
    const { right, above, away } = this.camera();
    const high = Math.tan(ANGLE / 2);
    const wide = high * Math.max(0.2, this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight));
    const far = places.map((place) => {
      const way = sub(place, this.centre);
      return dot(way, away) + Math.max(Math.abs(dot(way, above)) / high, Math.abs(dot(way, right)) / wide);
    });
    const least = (0.6 * this.radius) / high;
    return 1.12 * far.reduce((most, x) => (x > most ? x : most), least) + 0.1 * this.radius;
  }

  distance() {
    return (this.reach ?? this.radius / Math.sin(ANGLE / 2)) * this.zoom;
  }

  camera() {
    const { azimuth, elevation } = this;
    const away = [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
    const right = unit(cross([0, 0, 1], away));
    return { eye: add(this.centre, scale(away, this.distance())), right, above: cross(away, right), away };
  }

  begin(paper) {
    const { gl, canvas } = this;
    resize(canvas);
    const { width, height } = canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(...paper);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const far = this.distance() + 20 * this.radius;
    // A narrow picture shows as much across as a wide one shows up.
    const aspect = width / Math.max(1, height);
    const angle = aspect < 1 ? 2 * Math.atan(Math.tan(ANGLE / 2) / aspect) : ANGLE;
    this.lens = perspective(angle, aspect, this.distance() / 100, far);
    this.view = lookAt(this.camera().eye, this.centre, [0, 0, 1]);
  }

  /** A solid; `glow` 1 has no shades. */
  solid(mesh, model, rgba, glow = 0) {
    const { gl, solids } = this;
    const { buffer, count } = typeof mesh === "string" ? this.meshes[mesh] : mesh;
    if (rgba[3] < 1) gl.enable(gl.BLEND);
    else gl.disable(gl.BLEND);
    gl.useProgram(solids.program);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 24, 0);
    gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 24, 12);
    // In doubles, so that what is far from the origin does not tremble.
    const seen = multiply(this.view, model);
    const squared = [0, 4, 8].map((i) => seen[i] ** 2 + seen[i + 1] ** 2 + seen[i + 2] ** 2);
    gl.uniformMatrix4fv(solids.at.model, false, seen);
    gl.uniformMatrix4fv(solids.at.lens, false, this.lens);
    // Normals are turned by the inverse of the scales.
    gl.uniform3f(solids.at.flatten, ...squared.map((x) => Math.max(x, 1e-30)));
    gl.uniform4f(solids.at.colour, ...rgba);
    gl.uniform1f(solids.at.glow, glow);
    gl.drawArrays(gl.TRIANGLES, 0, count);
  }

  /** Lines along places `[x, y, z, opacity, …]`. */
  line(numbers, rgba, isStrip = true) {
    const { gl, lines } = this;
    if (numbers.length < 8) return;
    gl.enable(gl.BLEND);
    gl.useProgram(lines.program);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.strip);
    gl.bufferData(gl.ARRAY_BUFFER, numbers instanceof Float32Array ? numbers : new Float32Array(numbers), gl.STREAM_DRAW);
    gl.enableVertexAttribArray(0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 16, 0);
    gl.vertexAttribPointer(1, 1, gl.FLOAT, false, 16, 12);
    gl.uniformMatrix4fv(lines.at.both, false, multiply(this.lens, this.view));
    gl.uniform4f(lines.at.colour, ...rgba);
    gl.drawArrays(isStrip ? gl.LINE_STRIP : gl.LINES, 0, numbers.length / 4);
  }

  /** A plane of lines at this height under the centre, fading outwards. */
  ground(height, rgba) {
    const power = 10 ** Math.floor(Math.log10(this.radius / 2.5));
    const width = power * [1, 2, 5, 10].find((factor) => factor * power >= this.radius / 2.5);
    const [cx, cy] = [0, 1].map((i) => Math.round(this.centre[i] / width) * width);
    const count = 8;
    const reach = count * width;
    const numbers = [];
    for (let i = -count; i <= count; i++) {
      const fade = 1 - Math.abs(i) / (count + 1);
      for (const swap of [false, true]) {
        const at = (along, opacity) => numbers.push(...(swap ? [cx + along, cy + i * width] : [cx + i * width, cy + along]), height, opacity);
        [[-reach, 0], [0, fade], [0, fade], [reach, 0]].forEach(([along, opacity]) => at(along, opacity));
      }
    }
    this.line(numbers, rgba, false);
    return width;
  }

  /** Three arrows of this length: x red, y green, z blue. */
  axes(frame, size, [x, y, z], alpha) {
    const at = pose(frame);
    [x, y, z].forEach((rgb, i) => {
      const origin = at.slice(12, 15);
      const tip = add(origin, scale(at.slice(4 * i, 4 * i + 3), size));
      this.solid("cylinder", between(origin, tip, size * 0.035), [...rgb.slice(0, 3), alpha], 0.35);
    });
  }

  /** A ball. */
  ball(place, radius, rgba, mesh = "sphere") {
    const at = identity();
    [at[0], at[5], at[10]] = [radius, radius, radius];
    [at[12], at[13], at[14]] = place;
    this.solid(mesh, at, rgba);
  }

  /** A rod. */
  rod(from, to, radius, rgba) {
    if (length(sub(to, from)) > 1e-9 * this.radius) this.solid("cylinder", between(from, to, radius), rgba);
  }
}
