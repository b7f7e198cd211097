//! Rotor speeds from thrust and torques, and back: (5.4).
//!
//! ```text
//! U  = b (Ω₁² + Ω₂² + Ω₃² + Ω₄²)        τx = b l (Ω₄² − Ω₂²)
//! τz = d (Ω₁² − Ω₂² + Ω₃² − Ω₄²)        τy = b l (Ω₃² − Ω₁²)
//! ```
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, equation (5.4).

use mbs_runtime::Scalar;

use mbs_models::quadrotor_euler::Params;

/// What the rotors do together: thrust along the body's z axis \[N\], torques about its axes \[N·m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// U \[N\].
    pub thrust: f64,
    /// τ \[N·m\].
    pub torque: [f64; 3],
}

/// Speeds of the rotors, and whether they are what was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorSpeeds {
    /// Ω \[rad/s\].
    pub speed: [f64; 4],
    /// The least square of a speed that was asked for \[rad²/s²\]: one below zero was taken as zero.
    pub least_square: f64,
    /// The greatest speed that was asked for \[rad/s\]: one above the limit was taken as the limit.
    pub greatest: f64,
    /// Whether a speed was limited.
    pub saturated: bool,
}

/// The map between rotor speeds and efforts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer {
    /// b \[N·s²\], positive.
    pub thrust_factor: f64,
    /// d \[N·m·s²\], positive.
    pub drag_factor: f64,
    /// l \[m\], positive.
    pub arm: f64,
    /// The greatest speed of a rotor \[rad/s\]; infinite where there is no limit.
    pub greatest_speed: f64,
}

impl Mixer {
    /// That of a quadrotor, without a limit of speed.
    #[must_use]
    pub fn new(params: &Params<f64>) -> Self {
        let Params { thrust_factor, drag_factor, arm, .. } = *params;
        Mixer { thrust_factor, drag_factor, arm, greatest_speed: f64::INFINITY }
    }

    /// What rotors with these speeds do.
    #[must_use]
    pub fn effort(&self, speed: &[f64; 4]) -> Effort {
        let [a, b, c, d] = speed.map(|speed| speed * speed);
        let lever = self.thrust_factor * self.arm;
        Effort {
            thrust: self.thrust_factor * (a + b + c + d),
            torque: [lever * (d - b), lever * (c - a), self.drag_factor * (a - b + c - d)],
        }
    }

    /// The speeds for an effort; squares below zero become zero, speeds above the limit the limit.
    #[must_use]
    pub fn speeds(&self, effort: &Effort) -> RotorSpeeds {
        let [x, y, z] = effort.torque;
        let lever = self.thrust_factor * self.arm;
        let (sum, difference) = (effort.thrust / self.thrust_factor, z / self.drag_factor);
        let (odd, even) = ((sum + difference) / 4.0, (sum - difference) / 4.0);
        let (pitch, roll) = (y / lever / 2.0, x / lever / 2.0);
        let squares = [odd - pitch, even - roll, odd + pitch, even + roll];
        // NaN stays NaN.
        let least_square = squares.into_iter().fold(f64::INFINITY, |a, b| if b < a || b.is_nan() { b } else { a });
        let asked = squares.map(|square| Scalar::sqrt(if square < 0.0 { 0.0 } else { square }));
        let greatest = asked.into_iter().fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a });
        RotorSpeeds {
            speed: asked.map(|speed| if speed > self.greatest_speed { self.greatest_speed } else { speed }),
            least_square,
            greatest,
            saturated: least_square < 0.0 || greatest > self.greatest_speed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `quad.mixer_point` of the reference values.
    #[test]
    fn speeds_of_the_reference_point() {
        let mixer = Mixer::new(&Params::default());
        let effort = Effort { thrust: 420.0, torque: [10.0, -6.0, 2.0] };
        let speeds = mixer.speeds(&effort);
        let expected = [349.02461491731754, 258.19888974716116, 338.4456448906597, 280.6917861068948];
        assert!(speeds.speed.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{speeds:?}");
        let back = mixer.effort(&speeds.speed);
        assert!((back.thrust - 420.0).abs() < 1e-9 && !speeds.saturated);
        assert!(back.torque.iter().zip(effort.torque).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn what_is_no_number_is_no_speed() {
        let mixer = Mixer::new(&Params::default());
        let speeds = mixer.speeds(&Effort { thrust: f64::NAN, torque: [0.0; 3] });
        assert!(speeds.speed.iter().all(|speed| speed.is_nan()));
    }

    #[test]
    fn demands_beyond_the_rotors_are_limited_and_said() {
        let mixer = Mixer { greatest_speed: 400.0, ..Mixer::new(&Params::default()) };
        let falling = mixer.speeds(&Effort { thrust: 10.0, torque: [20.0, 0.0, 0.0] });
        assert!(falling.saturated && falling.least_square < 0.0 && falling.speed[1] == 0.0);
        let rising = mixer.speeds(&Effort { thrust: 900.0, torque: [0.0; 3] });
        assert!(rising.saturated && rising.greatest > 400.0 && rising.speed == [400.0; 4]);
    }
}
