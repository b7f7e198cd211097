//! Everyone who computes the dynamics of the benchmark arm, function by function.

use mbs_examples::contest::Contender;
use mbs_models::arm6::Arm6;
use mbs_models::arm6_params::Params;
use mbs_runtime::wide::f64x4;
use mbs_runtime::{Lanes, Packed};

use crate::featherstone::Model;
use crate::states::{State, States};
use crate::{custom_lanes, custom_newton_euler, custom_vector_sines};

/// One function of one contender: what it gives for each state, and what is timed.
pub(crate) struct Entry<'s> {
    pub(crate) results: Vec<Vec<f64>>,
    pub(crate) timed: Contender<'s>,
}

/// Every function with its contenders, the generated code first.
pub(crate) fn of_arm6(states: &States) -> Vec<(&'static str, Vec<Entry<'_>>)> {
    let (arm, arms) = (Arm6::<f64>::default(), Arm6::<f64x4>::default());
    let [mut inverse, mut bias, mut mass, mut forward, mut coriolis] = std::array::from_fn(|_| general_model());
    /// Generated code, the three ways to compile the customised one, and the general algorithm, of one function.
    macro_rules! contenders {
        ($function:ident($($argument:ident),+), $general:expr) => {{
            let all = vec![
                one_by_one("mbs", states, move |s| arm.$function($(&s.$argument),+)),
                in_lanes("mbs_batch", states, move |s| arms.$function($(&s.$argument),+)),
                one_by_one("custom_newton_euler", states, |s| custom_newton_euler::arm::$function($(&s.$argument),+)),
                one_by_one("custom_vector_sines", states, |s| custom_vector_sines::arm::$function($(&s.$argument),+)),
                in_lanes("custom_lanes", states, |s| custom_lanes::arm::$function($(&s.$argument),+)),
                one_by_one("featherstone_nalgebra", states, $general),
            ];
            (stringify!($function), all)
        }};
    }
    vec![
        contenders!(inverse_dynamics(q, qd, qdd), move |s| inverse.inverse_dynamics(&s.q, &s.qd, Some(&s.qdd))),
        contenders!(bias(q, qd), move |s| bias.inverse_dynamics(&s.q, &s.qd, None)),
        contenders!(mass_matrix(q), move |s| mass.mass_matrix(&s.q)),
        contenders!(forward_dynamics(q, qd, tau), move |s| forward.forward_dynamics(&s.q, &s.qd, &s.tau)),
        (
            "coriolis_matrix",
            vec![
                one_by_one("mbs", states, move |s| arm.coriolis_matrix(&s.q, &s.qd)),
                in_lanes("mbs_batch", states, move |s| arms.coriolis_matrix(&s.q, &s.qd)),
                one_by_one("featherstone_nalgebra", states, move |s| coriolis.coriolis_matrix(&s.q, &s.qd)),
            ],
        ),
    ]
}

/// Of one state after the other.
fn one_by_one<'s, P: Numbers<f64>>(
    name: &'static str,
    states: &'s States,
    mut call: impl FnMut(&State<f64>) -> P + Clone + 's,
) -> Entry<'s> {
    let timed = Contender::new(name, &states.one_by_one, call.clone());
    Entry { results: states.one_by_one.iter().map(|state| call(state).numbers(0)).collect(), timed }
}

/// Of four states at once.
fn in_lanes<'s, P: Numbers<f64x4>>(
    name: &'static str,
    states: &'s States,
    mut call: impl FnMut(&State<f64x4>) -> P + Clone + 's,
) -> Entry<'s> {
    let timed = Contender::new(name, &states.in_lanes, call.clone());
    let of_four = |four| {
        let result = call(four);
        (0..f64x4::COUNT).map(|lane| result.numbers(lane)).collect::<Vec<_>>()
    };
    Entry { results: states.in_lanes.iter().flat_map(of_four).collect(), timed }
}

/// What a contender returns, as the numbers of one lane.
trait Numbers<L> {
    fn numbers(&self, lane: usize) -> Vec<f64>;
}

impl<L: Lanes<Real = f64>, const N: usize> Numbers<L> for [L; N] {
    fn numbers(&self, lane: usize) -> Vec<f64> {
        self.each(lane).to_vec()
    }
}

impl<L: Lanes<Real = f64>, const N: usize> Numbers<L> for [[L; N]; N] {
    fn numbers(&self, lane: usize) -> Vec<f64> {
        self.each(lane).concat()
    }
}

/// The arm, as the general algorithms take it.
fn general_model() -> Model {
    let p = Params::<f64>::default();
    let (quarter, [d1, d4, d6], [a1, a2, a3]) = (std::f64::consts::FRAC_PI_2, p.d, p.a);
    let geometry = [
        [d1, a1, -quarter],
        [0.0, a2, 0.0],
        [0.0, a3, -quarter],
        [d4, 0.0, quarter],
        [0.0, 0.0, -quarter],
        [d6, 0.0, 0.0],
    ];
    let links: [_; 6] = std::array::from_fn(|i| {
        let inertia = [p.i_xx[i], p.i_yy[i], p.i_zz[i], p.i_xy[i], p.i_xz[i], p.i_yz[i]];
        (geometry[i], p.mass[i], [p.com_x[i], p.com_y[i], p.com_z[i]], inertia)
    });
    Model::serial(&links, p.g)
}
