//! A slider-crank with uniform crank and rod; angles from the x axis, along which the piston slides, towards y; gravity
//! along −y.
//!
//! # Source
//!
//! Lagrange's equations of a two-link chain and a piston, closed by multipliers: Wittenburg, *Dynamics of Multibody
//! Systems*, 2nd edition 2008, on closed chains. Verified here against the linkage with the crank's angle as its only
//! coordinate, the piston's place in closed form.

use super::dynamics::Dynamics;

/// Parameters and inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderCrank {
    /// Masses of crank, rod and piston, in kg.
    pub m: [f64; 3],
    /// Lengths of crank and rod, in m.
    pub l: [f64; 2],
    /// Height of the piston's line, in m.
    pub offset: f64,
    /// Gravity, in m/s².
    pub g: f64,
    /// Friction of the piston, in N·s/m.
    pub c: f64,
    /// Torque on the crank, in N·m, and force on the piston towards the crank, in N.
    pub inputs: [f64; 2],
}

impl SliderCrank {
    /// Rod and piston with the crank, the piston on the far side; none where the rod is too short.
    pub fn closed(&self, crank: f64) -> Option<[f64; 3]> {
        let ([r, l], (s, c)) = (self.l, crank.sin_cos());
        let sine = (self.offset - r * s) / l;
        (sine.abs() <= 1.0).then(|| [crank, sine.asin(), r * c + l * (1.0 - sine * sine).sqrt()])
    }

    /// Rates with that of the crank.
    pub fn closed_rates(&self, &[q1, q2, _]: &[f64; 3], rate: f64) -> [f64; 3] {
        let [r, l] = self.l;
        let rod = -r * q1.cos() / (l * q2.cos()) * rate;
        [rate, rod, -r * q1.sin() * rate - l * q2.sin() * rod]
    }
}

/// Coordinates `[crank, rod, x]`.
impl Dynamics<3> for SliderCrank {
    fn mass_matrix(&self, &[q1, q2, _]: &[f64; 3]) -> [[f64; 3]; 3] {
        let ([m1, m2, m3], [r, l]) = (self.m, self.l);
        let coupling = 0.5 * m2 * r * l * (q1 - q2).cos();
        [[(m1 / 3.0 + m2) * r * r, coupling, 0.0], [coupling, m2 * l * l / 3.0, 0.0], [0.0, 0.0, m3]]
    }

    fn bias(&self, &[q1, q2, _]: &[f64; 3], &[w1, w2, _]: &[f64; 3]) -> [f64; 3] {
        let ([m1, m2, _], [r, l], g) = (self.m, self.l, self.g);
        let pull = 0.5 * m2 * r * l * (q1 - q2).sin();
        [pull * w2 * w2 + (0.5 * m1 + m2) * g * r * q1.cos(), -pull * w1 * w1 + 0.5 * m2 * g * l * q2.cos(), 0.0]
    }

    fn force(&self, _: &[f64; 3], &[_, _, xd]: &[f64; 3]) -> [f64; 3] {
        let [tau, gas] = self.inputs;
        [tau, 0.0, -gas - self.c * xd]
    }

    /// `r e(q₁) + l e(q₂) − [x, offset] = 0`.
    fn constraints(&self, &[q1, q2, _]: &[f64; 3], &[w1, w2, _]: &[f64; 3]) -> Vec<([f64; 3], f64)> {
        let [r, l] = self.l;
        let (s, c) = ([r * q1.sin(), l * q2.sin()], [r * q1.cos(), l * q2.cos()]);
        vec![
            ([-s[0], -s[1], -1.0], -c[0] * w1 * w1 - c[1] * w2 * w2),
            ([c[0], c[1], 0.0], -s[0] * w1 * w1 - s[1] * w2 * w2),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::reference::dynamics::motion;
    use crate::reference::lagrange::{self, Number, Particles, rod};

    const ENGINE: SliderCrank =
        SliderCrank { m: [0.9, 0.6, 0.5], l: [0.3, 1.1], offset: 0.1, g: 9.81, c: 0.8, inputs: [2.0, 7.0] };

    /// The crank's angle alone; z is up.
    impl Particles<1> for SliderCrank {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, &[crank]: &[S; 1]) -> Vec<(f64, [S; 3])> {
            let [r, l] = self.l;
            let zero = S::constant(0.0);
            let (origin, pin) = ([zero; 3], [crank.cos() * r, zero, crank.sin() * r]);
            let height = S::constant(self.offset);
            let rise = height - pin[2];
            let piston = [pin[0] + (S::constant(l * l) - rise * rise).sqrt(), zero, height];
            let rods = [rod(self.m[0], origin, pin), rod(self.m[1], pin, piston)];
            rods.into_iter().flatten().chain([(self.m[2], piston)]).collect()
        }
    }

    /// Three coordinates and two multipliers move the crank as one coordinate without any does, all the way round.
    #[test]
    fn agrees_with_the_crank_alone() {
        for step in 0..24 {
            let (crank, rate) = (0.1 + 0.26 * f64::from(step), 3.0 - 0.2 * f64::from(step));
            let q = ENGINE.closed(crank).expect("the rod is long enough");
            let qd = ENGINE.closed_rates(&q, rate);
            let motion = motion(&ENGINE, &q, &qd).expect("regular");
            let m = lagrange::mass_matrix(&ENGINE, &[crank])[0][0];
            let h = lagrange::euler_lagrange(&ENGINE, &[crank], &[rate], &[0.0])[0];
            // The virtual work of gas and friction, by the piston's velocity per rate of the crank.
            let [tau, gas] = ENGINE.inputs;
            let force = tau - (gas + ENGINE.c * qd[2]) * ENGINE.closed_rates(&q, 1.0)[2];
            assert_close("crank", &motion.accelerations[..1], &[(force - h) / m], 1e-11);
        }
    }

    #[test]
    fn closed_loops_are_closed() {
        let q = ENGINE.closed(0.7).expect("it closes");
        let qd = ENGINE.closed_rates(&q, 1.3);
        let sum = |of: fn(f64) -> f64| ENGINE.l[0] * of(q[0]) + ENGINE.l[1] * of(q[1]);
        assert_close("φ", &[sum(f64::cos), sum(f64::sin)], &[q[2], ENGINE.offset], 1e-14);
        for (row, _) in ENGINE.constraints(&q, &qd) {
            assert!(row.iter().zip(qd).map(|(a, rate)| a * rate).sum::<f64>().abs() < 1e-14);
        }
    }
}
