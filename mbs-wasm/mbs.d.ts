// Types of mbs.js. SI units; angles in radians; matrices row by row in one array.

/** Numbers in order. */
export type Numbers = readonly number[] | Float64Array | Float32Array;
/** Numbers in order, or some by the name of a variable or of a component; of an array variable all of its components. */
export type Vector = Numbers | Record<string, number | Numbers | readonly Numbers[]>;

export interface State {
  /** Time in s; 0 if not given. */
  t?: number;
  /** Coordinates; they alone have no value where they are not given. */
  q: Vector;
  /** Velocities; zero if not given, as accelerations and inputs are. */
  qd?: Vector;
  qdd?: Vector;
  u?: Vector;
  /** Parameters; those that are not given by name have their declared defaults. */
  params?: Vector;
  /** Prescribed motions: value, rate and acceleration. */
  prescribed?: Record<string, number | Numbers>;
}

/** A number, a table `[times, values]` that is straight in between, or a function. */
export type Signal = number | readonly [Numbers, Numbers] | ((t: number, q: Float64Array, qd: Float64Array) => number);

export interface Event {
  /** The column that passes `value`: a coordinate, `theta_dot`, an output … */
  of: string;
  value?: number;
  direction?: "falling" | "any" | "rising";
  /** Whether the motion ends there. */
  stop?: boolean;
  /** Velocities by name, `theta_dot`, and what they are multiplied by there: an impact. */
  multiply?: Record<string, number>;
}

export interface Simulation extends Omit<State, "prescribed"> {
  t_end: number;
  /** Seconds between rows, and the step of methods without error control; a thousandth of the time if not given. */
  dt?: number;
  /** The longest step of dop853 and dopri5, which step over what comes and goes in less time; `dt` if not given. */
  max_step?: number;
  method?: "dop853" | "dopri5" | "rk4" | "gauss-legendre4" | "stormer-verlet" | "semi-implicit-euler";
  /** Relative tolerance of dop853 and dopri5, 1e-10 if not given. */
  tolerance?: number;
  /** Absolute tolerance, a hundredth of the relative one if not given. */
  atol?: number;
  /** In order, or by name, of an array all its components, too; or all inputs as one function. Zero if not given. */
  inputs?: Numbers | Record<string, Signal | Numbers | readonly Numbers[]> | ((t: number, q: Float64Array, qd: Float64Array) => Vector);
  prescribed?: Record<string, number | Numbers | ((t: number) => Numbers)>;
  events?: readonly Event[];
  /** Whether states are projected onto constraints after each step; true if not given. */
  project?: boolean;
  /** Constraints that depend on others: refused, or multipliers of the least norm. */
  redundant?: "refuse" | "least-norm";
  /** Coordinates that stay as given when the first state is brought onto the constraints. */
  hold?: readonly string[];
}

export interface Motion {
  t: Float64Array;
  /** By name: `t`, coordinates, `x_dot`, `kinetic_energy`, `potential_energy`, `energy`, `lambda_…`, `residual_…`, outputs. */
  columns: Record<string, Float64Array>;
  units: Record<string, string>;
  /** What happened: the number of the event among those asked for, its column, and when. */
  events: { event: number; of: string; t: number }[];
  summary: {
    time: number;
    /** Whether an event ended the motion. */
    stopped: boolean;
    evaluations: number;
    accepted: number;
    rejected: number;
    /** Whether the start was moved to satisfy the constraints. */
    assembled: boolean;
    rows: number;
  };
}

export interface Linearization {
  /** `∂q̈/∂q`, `∂q̈/∂q̇`, `∂q̈/∂u`. */
  q: Float64Array;
  qd: Float64Array;
  u: Float64Array;
  /** `d(q, q̇)/dt ≈ A (δq, δq̇) + B δu`: `states` × `states`, and `states` × `inputs`. */
  A: Float64Array;
  B: Float64Array;
  states: number;
  inputs: number;
}

export interface Pose {
  position: Float64Array;
  /** Body axes to world axes, row by row. */
  rotation: Float64Array;
}

export interface Wrench {
  force: Float64Array;
  moment: Float64Array;
}

export type Part = number | Float64Array | Pose | Wrench | Pose[] | Wrench[];

export interface Operations {
  add: number;
  mul: number;
  div: number;
  sqrt: number;
  sincos: number;
  other: number;
  flops: number;
}

export interface FunctionDescription {
  name: string;
  number: number;
  docs: string;
  /** What it takes beside t, parameters and prescribed motions: `q`, `qd`, `qdd`, `u`, `multipliers`. */
  arguments: string[];
  /** One result without a name, or named ones; `shape` are its lengths. */
  results: { name: string; kind: "number" | "array" | "pose" | "wrench"; shape: number[] }[];
  /** Of an output, the units of its components in SI base units. */
  units: string[] | null;
  operations: Operations;
}

export interface Variable {
  name: string;
  docs: string;
  unit: string;
  /** The unit that its default was declared in, where that is another. */
  declared_unit: string | null;
  /** `[]`, `[n]`, or `[rows, columns]`. */
  lengths: number[];
  /** The number of its first component among all of its kind. */
  first: number;
  components: string[];
  defaults: number[];
  positive: boolean;
}

/** A place in a file: lines and columns from 1 and length in characters, `start` and `end` as strings count. */
export interface Place {
  file: string;
  line: number;
  column: number;
  length: number;
  start: number;
  end: number;
}

export interface Diagnostic extends Place {
  severity: "error" | "warning";
  /** Its cause, as `mbs explain` knows it: `MBS0401`. */
  code: string;
  message: string;
  /** What to write instead. */
  help: string | null;
  notes: (Place & { message: string })[];
}

export class MbsError extends Error {}
export class ModelError extends MbsError {
  report: string;
  diagnostics: Diagnostic[];
}
export class InputError extends MbsError {}
export class MotionError extends MbsError {
  t: number;
  q: number[];
  qd: number[];
}
export class InternalError extends MbsError {}

export interface Model {
  name: string;
  docs: string;
  coordinates: Variable[];
  parameters: Variable[];
  inputs: Variable[];
  prescribed: Variable[];
  coordinateNames: string[];
  parameterNames: string[];
  inputNames: string[];
  prescribedNames: string[];
  constraints: { name: string; unit: string; multiplier_unit: string; holonomic: boolean }[];
  /** First integrals: `energy_integral`, or `p_` and the coordinate. */
  conserved: string[];
  depends_on_time: boolean;
  functions: Record<string, FunctionDescription>;
  /** The columns of a motion. */
  columns: { name: string; unit: string }[];
  /** At how many states it was proved, and at how many of them some motion has no inertia. */
  proof: { states: number; singular: number };
  warnings: Diagnostic[];
  /** The warnings for people. */
  report: string;
  emit(language: "rust" | "c" | "latex" | "mathml" | "review"): string;
  rust(): string;
  latex(): string;
  ops(): Record<string, Operations>;
  evaluate(name: string, state: State): Part | Record<string, Part>;
  linearize(state: State): Linearization;
  simulate(options: Simulation): Motion;
  free(): void;
}

export interface Mbs {
  compile(text: string, options?: { name?: string; files?: Record<string, string> }): Model;
  readonly memoryBuffer: ArrayBuffer;
}

export function load(source?: URL | string | Response | BufferSource | WebAssembly.Module | Promise<Response>): Promise<Mbs>;
