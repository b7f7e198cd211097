//! A four-bar linkage of uniform rods, angles of crank, coupler and rocker from the x axis towards z, gravity along −z.
//!
//! # Source
//!
//! Lagrange's equations of a two-link chain and a rod in absolute angles, closed by multipliers: Wittenburg, *Dynamics
//! of Multibody Systems*, 2nd edition 2008, on closed chains. Verified here against the linkage with the crank's angle
//! as its only coordinate, the place of the last hinge found as the meeting of two circles.

use super::dynamics::Dynamics;

/// Parameters and input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar {
    /// Masses of crank, coupler and rocker, in kg.
    pub m: [f64; 3],
    /// Lengths, in m.
    pub l: [f64; 3],
    /// Distance of the fixed hinges, in m.
    pub ground: f64,
    /// Gravity, in m/s².
    pub g: f64,
    /// Torque on the crank, in N·m.
    pub tau: f64,
}

impl FourBar {
    /// The angles of coupler and rocker at which the loop closes, the hinge on the left of the line from knee to base;
    /// none where it cannot.
    pub fn closed(&self, crank: f64) -> Option<[f64; 3]> {
        let ([l1, l2, l3], (s, c)) = (self.l, crank.sin_cos());
        let (x, z) = (self.ground - l1 * c, -l1 * s);
        let distance = x.hypot(z);
        // Cosine rule in the triangle of knee, hinge and base.
        let cosine = (l2 * l2 + distance * distance - l3 * l3) / (2.0 * l2 * distance);
        let coupler = (cosine.abs() <= 1.0).then(|| z.atan2(x) + cosine.acos())?;
        let rocker = (l2 * coupler.sin() - z).atan2(l2 * coupler.cos() - x);
        Some([crank, coupler, rocker])
    }

    /// The rates of coupler and rocker with the crank's: the loop's velocity, by Cramer's rule.
    pub fn closed_rates(&self, &[q1, q2, q3]: &[f64; 3], rate: f64) -> [f64; 3] {
        let [l1, l2, l3] = self.l;
        let coupler = -l1 * (q1 - q3).sin() / (l2 * (q2 - q3).sin());
        let rocker = l1 * (q1 - q2).sin() / (l3 * (q3 - q2).sin());
        [rate, coupler * rate, rocker * rate]
    }
}

/// Coordinates `[crank, coupler, rocker]`.
impl Dynamics<3> for FourBar {
    fn mass_matrix(&self, &[q1, q2, _]: &[f64; 3]) -> [[f64; 3]; 3] {
        let ([m1, m2, m3], [l1, l2, l3]) = (self.m, self.l);
        let coupling = 0.5 * m2 * l1 * l2 * (q1 - q2).cos();
        [
            [(m1 / 3.0 + m2) * l1 * l1, coupling, 0.0],
            [coupling, m2 * l2 * l2 / 3.0, 0.0],
            [0.0, 0.0, m3 * l3 * l3 / 3.0],
        ]
    }

    fn bias(&self, &[q1, q2, q3]: &[f64; 3], &[w1, w2, _]: &[f64; 3]) -> [f64; 3] {
        let ([m1, m2, m3], [l1, l2, l3], g) = (self.m, self.l, self.g);
        let pull = 0.5 * m2 * l1 * l2 * (q1 - q2).sin();
        [
            pull * w2 * w2 + (0.5 * m1 + m2) * g * l1 * q1.cos(),
            -pull * w1 * w1 + 0.5 * m2 * g * l2 * q2.cos(),
            0.5 * m3 * g * l3 * q3.cos(),
        ]
    }

    fn force(&self, _: &[f64; 3], _: &[f64; 3]) -> [f64; 3] {
        [self.tau, 0.0, 0.0]
    }

    /// `l₁ e(q₁) + l₂ e(q₂) − l₃ e(q₃) = [ground, 0]`.
    fn constraints(&self, q: &[f64; 3], qd: &[f64; 3]) -> Vec<([f64; 3], f64)> {
        let signed = [self.l[0], self.l[1], -self.l[2]];
        let row = |of: fn(f64) -> f64| std::array::from_fn(|i| signed[i] * of(q[i]));
        let bias = |of: fn(f64) -> f64| (0..3).map(|i| -signed[i] * of(q[i]) * qd[i] * qd[i]).sum();
        vec![(row(|angle| -angle.sin()), bias(f64::cos)), (row(f64::cos), bias(f64::sin))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::reference::dynamics::motion;
    use crate::reference::lagrange::{self, Number, Particles, rod};

    const LINKAGE: FourBar = FourBar { m: [0.3, 0.8, 0.5], l: [0.2, 0.65, 0.5], ground: 0.55, g: 9.81, tau: 0.4 };

    /// The crank's angle alone: rods between knee, hinge and fixed points.
    impl Particles<1> for FourBar {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, &[crank]: &[S; 1]) -> Vec<(f64, [S; 3])> {
            let [l1, l2, l3] = self.l;
            let zero = S::constant(0.0);
            let (origin, base) = ([zero; 3], [S::constant(self.ground), zero, zero]);
            let knee = [crank.cos() * l1, zero, crank.sin() * l1];
            // The circles about knee and base meet `along` the line between them and `aside` of it.
            let line = [base[0] - knee[0], base[2] - knee[2]];
            let distance = (line[0] * line[0] + line[1] * line[1]).sqrt();
            let along = (distance * distance + S::constant(l2 * l2 - l3 * l3)) / (distance * 2.0);
            let aside = (S::constant(l2 * l2) - along * along).sqrt();
            let (along, aside) = (along / distance, aside / distance);
            let hinge =
                [knee[0] + line[0] * along - line[1] * aside, zero, knee[2] + line[1] * along + line[0] * aside];
            [rod(self.m[0], origin, knee), rod(self.m[1], knee, hinge), rod(self.m[2], base, hinge)].concat()
        }
    }

    /// Three coordinates and two multipliers move the crank as one coordinate without any does, all the way round.
    #[test]
    fn agrees_with_the_crank_alone() {
        for step in 0..24 {
            let (crank, rate) = (0.1 + 0.26 * f64::from(step), 3.0 - 0.2 * f64::from(step));
            let q = LINKAGE.closed(crank).expect("the crank turns all the way round");
            let qd = LINKAGE.closed_rates(&q, rate);
            let motion = motion(&LINKAGE, &q, &qd).expect("regular");
            let m = lagrange::mass_matrix(&LINKAGE, &[crank])[0][0];
            let h = lagrange::euler_lagrange(&LINKAGE, &[crank], &[rate], &[0.0])[0];
            assert_close("crank", &motion.accelerations[..1], &[(LINKAGE.tau - h) / m], 1e-11);
        }
    }

    #[test]
    fn closed_loops_are_closed() {
        let q = LINKAGE.closed(0.7).expect("it closes");
        let qd = LINKAGE.closed_rates(&q, 1.3);
        let sum = |of: fn(f64) -> f64| LINKAGE.l[0] * of(q[0]) + LINKAGE.l[1] * of(q[1]) - LINKAGE.l[2] * of(q[2]);
        assert_close("φ", &[sum(f64::cos), sum(f64::sin)], &[LINKAGE.ground, 0.0], 1e-14);
        for (row, _) in LINKAGE.constraints(&q, &qd) {
            assert!(row.iter().zip(qd).map(|(a, rate)| a * rate).sum::<f64>().abs() < 1e-14);
        }
    }
}
