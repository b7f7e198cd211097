//! A planar quadrotor with a load on a thread, hung below its mass centre.
//!
//! # Source
//!
//! Lagrange's equations over the load's place, `r = [x − d sin p + l sin a, z − d cos p − l cos a]` with pitch `p`
//! about +y, `d` from the mass centre to the hook and `a` the thread's angle from straight down: with `d = 0` the
//! planar model of Sreenath, Michael, Kumar, *Trajectory generation and control of a quadrotor with a cable-suspended
//! load*, ICRA 2013.

use super::dynamics::Dynamics;

/// Parameters and inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadrotorWithSlungLoad {
    /// Mass of the quadrotor, in kg.
    pub m: f64,
    /// Its moment of inertia, in kg·m².
    pub moment: f64,
    /// From its mass centre to each rotor, in m.
    pub arm: f64,
    /// From its mass centre down to the hook, in m.
    pub hook: f64,
    /// Mass of the load, in kg.
    pub m_load: f64,
    /// Length of the thread, in m.
    pub thread: f64,
    /// Gravity, in m/s².
    pub g: f64,
    /// Resistance against turning, in N·m·s.
    pub spin_drag: f64,
    /// Resistance against the load, in N·s/m.
    pub load_drag: f64,
    /// Thrust of the front and of the rear rotor, in N.
    pub thrust: [f64; 2],
}

impl QuadrotorWithSlungLoad {
    /// `∂r/∂p` and `∂r/∂a` of the load, components x and z.
    fn partials(&self, pitch: f64, swing: f64) -> [[f64; 2]; 2] {
        let (d, l) = (self.hook, self.thread);
        [[-d * pitch.cos(), d * pitch.sin()], [l * swing.cos(), l * swing.sin()]]
    }
}

/// Coordinates `[x, z, pitch, swing]`.
impl Dynamics<4> for QuadrotorWithSlungLoad {
    fn mass_matrix(&self, &[_, _, p, a]: &[f64; 4]) -> [[f64; 4]; 4] {
        let (total, m, d, l) = (self.m + self.m_load, self.m_load, self.hook, self.thread);
        let [[px, pz], [ax, az]] = self.partials(p, a).map(|row| row.map(|entry| m * entry));
        let coupling = -m * d * l * (p + a).cos();
        [
            [total, 0.0, px, ax],
            [0.0, total, pz, az],
            [px, pz, self.moment + m * d * d, coupling],
            [ax, az, coupling, m * l * l],
        ]
    }

    fn bias(&self, &[_, _, p, a]: &[f64; 4], &[_, _, pd, ad]: &[f64; 4]) -> [f64; 4] {
        let (d, l) = (self.hook, self.thread);
        // The load's acceleration at q̈ = 0, and gravity's.
        let right = self.m_load * (d * p.sin() * pd * pd - l * a.sin() * ad * ad);
        let up = self.m_load * (d * p.cos() * pd * pd + l * a.cos() * ad * ad + self.g);
        let [[px, pz], [ax, az]] = self.partials(p, a);
        [right, up + self.m * self.g, px * right + pz * up, ax * right + az * up]
    }

    fn force(&self, &[_, _, p, a]: &[f64; 4], &[xd, zd, pd, ad]: &[f64; 4]) -> [f64; 4] {
        let [front, rear] = self.thrust;
        let [[px, pz], [ax, az]] = self.partials(p, a);
        let right = -self.load_drag * (xd + px * pd + ax * ad);
        let up = -self.load_drag * (zd + pz * pd + az * ad);
        [
            (front + rear) * p.sin() + right,
            (front + rear) * p.cos() + up,
            self.arm * (rear - front) - self.spin_drag * pd + px * right + pz * up,
            ax * right + az * up,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::dynamics::{motion, tests::agrees_with_lagrange};
    use crate::reference::lagrange::{Number, Particles};

    const QUADROTOR: QuadrotorWithSlungLoad = QuadrotorWithSlungLoad {
        m: 1.2,
        moment: 0.05,
        arm: 0.3,
        hook: 0.2,
        m_load: 0.4,
        thread: 0.9,
        g: 9.81,
        spin_drag: 0.01,
        load_drag: 0.03,
        thrust: [6.0, 9.0],
    };

    /// The quadrotor as two halves at the radius of gyration.
    impl Particles<4> for QuadrotorWithSlungLoad {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, &[x, z, p, a]: &[S; 4]) -> Vec<(f64, [S; 3])> {
            let zero = S::constant(0.0);
            let radius = (self.moment / self.m).sqrt();
            // Body axes in the world: x [cos p, −sin p], z [sin p, cos p].
            let half = |r: f64| (0.5 * self.m, [x + p.cos() * r, zero, z - p.sin() * r]);
            let load = [
                x - p.sin() * self.hook + a.sin() * self.thread,
                zero,
                z - p.cos() * self.hook - a.cos() * self.thread,
            ];
            vec![half(radius), half(-radius), (self.m_load, load)]
        }
    }

    #[test]
    fn agrees_with_lagrange_over_particles() {
        agrees_with_lagrange(&QUADROTOR, &QUADROTOR);
    }

    /// The mass centre of the whole falls, but for thrust and drag: Newton's second law, whatever hangs together how.
    #[test]
    fn the_mass_centre_obeys_newton() {
        for state in states::<4>(12, 30) {
            let (q, qd) = (&state.q, &state.qd);
            let motion = motion(&QUADROTOR, q, qd).expect("regular");
            let [xdd, zdd, pdd, add] = motion.accelerations;
            let bias = QUADROTOR.bias(q, qd);
            let m = QUADROTOR.mass_matrix(q);
            let force = QUADROTOR.force(q, qd);
            let right = m[0][0] * xdd + m[0][2] * pdd + m[0][3] * add + bias[0];
            let up = m[1][1] * zdd + m[1][2] * pdd + m[1][3] * add + bias[1];
            assert_close("ṗ", &[right, up], &force[..2], 1e-11);
        }
    }
}
