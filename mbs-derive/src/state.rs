//! What the functions of a mechanism take.

use crate::expr::{Dual, Symbol, Value};

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

impl<V: Value> State<V> {
    /// The state with a derivative in some direction: that of each variable is `direction(symbol)`.
    pub fn along(&self, direction: impl Fn(Symbol) -> V) -> State<Dual<V>> {
        self.along_any(&direction)
    }

    /// The value of a variable; `None` of parameters and multipliers, which are no part of a state.
    pub(crate) fn value_of(&self, symbol: Symbol) -> Option<V> {
        Some(match symbol {
            Symbol::Time => self.t,
            Symbol::Coordinate(i) => self.q[i as usize],
            Symbol::Velocity(i) => self.qd[i as usize],
            Symbol::Acceleration(i) => self.qdd[i as usize],
            Symbol::Input(i) => self.u[i as usize],
            Symbol::Prescribed(i, order) => self.prescribed[i as usize][usize::from(order)],
            Symbol::Parameter(_) | Symbol::Multiplier(_) => return None,
        })
    }

    fn along_any(&self, direction: &dyn Fn(Symbol) -> V) -> State<Dual<V>> {
        let all = |values: &[V], symbol: fn(u32) -> Symbol| {
            values.iter().enumerate().map(|(i, &v)| Dual::new(v, direction(symbol(i as u32)))).collect()
        };
        let signals = self.prescribed.iter().enumerate().map(|(i, signal)| {
            [0, 1, 2].map(|order| Dual::new(signal[order], direction(Symbol::Prescribed(i as u32, order as u8))))
        });
        State {
            t: Dual::new(self.t, direction(Symbol::Time)),
            q: all(&self.q, Symbol::Coordinate),
            qd: all(&self.qd, Symbol::Velocity),
            qdd: all(&self.qdd, Symbol::Acceleration),
            u: all(&self.u, Symbol::Input),
            prescribed: signals.collect(),
        }
    }
}
