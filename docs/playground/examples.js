// What the menu offers: files of models/mechanisms, with a motion to begin with.

export const folder = new URL("../../models/mechanisms/", import.meta.url);

export const examples = [
  { file: "double_pendulum.mbs", title: "Double pendulum", q: { theta1: 2, theta2: 2.5 }, t_end: 15 },
  { file: "pendulum.mbs", title: "Pendulum", q: { theta: 2.5 }, t_end: 12 },
  { file: "cart_pole.mbs", title: "Cart and pole", q: { theta: 2.6 }, t_end: 12 },
  { file: "spherical_pendulum.mbs", title: "Spherical pendulum", q: { theta: 1 }, qd: { phi: 2.5 }, t_end: 12 },
  { file: "furuta_pendulum.mbs", title: "Furuta's pendulum", q: { theta: 2.5 }, qd: { alpha: 4 }, t_end: 10 },
  { file: "heavy_top.mbs", title: "Heavy top", q: { theta: 0.5 }, qd: { psi: 120 }, t_end: 3 },
  { file: "n_pendulum.mbs", title: "Chain of ten links", q: { theta: [1, 1, 1, 1, 1, 1, 1, 1, 1, 1] }, t_end: 6 },
  { file: "four_bar.mbs", title: "Four-bar linkage", q: { crank: 1, coupler: 0.5, rocker: 1.5 }, qd: { crank: 8 }, hold: ["crank"], t_end: 4 },
  { file: "kepler.mbs", title: "Kepler's problem", q: { r: [7e6, 0, 0] }, qd: { r: [0, 9e3, 0] }, t_end: 40000 },
  { file: "scara.mbs", title: "SCARA robot", qd: [0.5, -0.8, 0, 1], t_end: 4 },
  { file: "arm6.mbs", title: "Arm with six joints", q: [0, -1, 0.5, 0, 0.3, 0], t_end: 3 },
  { file: "quadrotor_euler.mbs", title: "Quadrotor", t_end: 3 },
];
