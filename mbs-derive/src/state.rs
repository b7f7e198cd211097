//! What the functions of a mechanism take.

/// The arguments of a mechanism's functions, flattened in declaration order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State<V = f64> {
    /// Time.
    pub t: V,
    /// Coordinates.
    pub q: Vec<V>,
    /// Velocities.
    pub qd: Vec<V>,
    /// Accelerations.
    pub qdd: Vec<V>,
    /// Inputs.
    pub u: Vec<V>,
    /// Prescribed motions: value, first and second derivative.
    pub prescribed: Vec<[V; 3]>,
}
