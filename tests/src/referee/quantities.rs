//! Every number that a generated function returns, from Lagrange's equations of the text.

use std::collections::BTreeMap;

use super::evaluate::State;
use super::lagrange::{Component, Equations, Wanted, Written};
use super::mechanism::{Mechanism, count};
use super::number::{Base, Dual, Real};
use super::solve::{Solution, solve};
use super::wide::Wide;

/// Results by the names of functions, flattened as the generated ones are.
pub(super) type Quantities = BTreeMap<String, Vec<f64>>;

/// Which columns of Jacobians and linearizations are wanted: one costs as much as all that is no derivative of the
/// equations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Directions {
    pub(super) q: Vec<usize>,
    pub(super) qd: Vec<usize>,
    pub(super) u: Vec<usize>,
    pub(super) parameters: Vec<usize>,
    /// Whether C is wanted, which costs as much as some columns.
    pub(super) coriolis: bool,
}

/// Stands for a number in a column that is not wanted.
const NOT_WANTED: f64 = f64::NAN;

/// The ranks of the bordered system; where rows are redundant λ is not determined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rank {
    pub(super) found: usize,
    pub(super) full: usize,
    /// Whether every motion that the constraints leave has inertia: q̈ is determined.
    pub(super) regular: bool,
    /// Whether no rounding makes another rank of it.
    pub(super) clear: bool,
    /// Whether there are no accelerations that satisfy all rows.
    pub(super) contradictory: bool,
    /// Whether a motion may be taken for one without inertia, or a row for one that depends on others: then everything
    /// that follows from accelerations may be NaN.
    pub(super) may_have_no_answer: bool,
    /// Whether a component of a constraint is so small beside the others of its vector that it may be one of its own,
    /// with accelerations that satisfy it, or what rounding leaves of none.
    pub(super) has_component_near_zero: bool,
}

impl Rank {
    /// Whether there are accelerations, and no others.
    pub(super) fn determined(self) -> bool {
        self.clear && self.regular && !self.contradictory
    }
}

/// Where constraints hold to rounding, rows that depend on others there do so to rounding.
const HELD: f64 = 1e-9;

/// Elsewhere they do so exactly, or not.
const ANYWHERE: f64 = 1e-20;

/// A pivot that is less than this by each coordinate may be none. Rounding leaves `N ε` of an inertia of 1
/// that is a sum of `N` terms, of which the runtime takes 16 (`dynamics/null_space.rs`), and elimination in another
/// order finds more or less of it by what it lets entries grow to, which is less than 1000 / 16.
const WITHOUT_INERTIA: f64 = 1000.0 * f64::EPSILON;

/// A derivative of all equations in one direction.
type Slopes<R> = Equations<Dual<R>>;

struct Bench<'m, R> {
    mechanism: &'m Mechanism,
    state: &'m State<R>,
    /// What the text adds up to at the state, and at rest there.
    here: Written,
    at_rest: Written,
    found: Quantities,
    /// Pivots below this count as zero.
    threshold: f64,
}

/// All quantities at a state; derivatives of the equations themselves in these directions, if any. `rank` is what the
/// bordered system is known to have, `held` whether the constraints hold.
pub(super) fn quantities<R: Base>(
    mechanism: &Mechanism,
    state: &State<R>,
    directions: Option<&Directions>,
    rank: Option<usize>,
    held: bool,
) -> Result<(Quantities, Rank), String> {
    let threshold = if held { HELD } else { ANYWHERE };
    let mut bench = Bench::new(mechanism, state, threshold)?;
    let rank = bench.measure(directions, rank)?;
    Ok((bench.found, rank))
}

/// The accelerations of a mechanism without constraints, under no inputs and no dissipation.
pub(super) fn free_motion<R: Base>(mechanism: &Mechanism, state: &State<R>) -> Result<Vec<f64>, String> {
    let n = mechanism.dof();
    let zero = |count: usize| vec![R::zero(); count];
    let state = State { qdd: zero(n), u: zero(state.u.len()), ..state.clone() };
    let bench = Bench::new(mechanism, &state, ANYWHERE)?;
    let here = bench.here.equations(&state, 0..n, Wanted::Motion);
    let mass = bench.mass(&state);
    let right: Vec<Wide> = here.force.iter().zip(&here.inertia).map(|(q, h)| (*q - *h).wide()).collect();
    let solution = solve(&bordered(&mass, &[]), &[right], ANYWHERE, None, || 0.0);
    Ok(solution.columns[0].iter().map(|x| x.value()).collect())
}

fn wide<R: Base>(values: &[R]) -> Vec<Wide> {
    values.iter().map(|x| x.wide()).collect()
}

fn at_rest<R: Base>(state: &State<R>) -> State<R> {
    let zero = vec![R::zero(); state.q.len()];
    State { qd: zero.clone(), qdd: zero, ..state.clone() }
}

impl<'m, R: Base> Bench<'m, R> {
    fn new(mechanism: &'m Mechanism, state: &'m State<R>, threshold: f64) -> Result<Self, String> {
        let (here, at_rest) = (Written::at(mechanism, state)?, Written::at(mechanism, &at_rest(state))?);
        Ok(Bench { mechanism, state, here, at_rest, found: Quantities::new(), threshold })
    }

    fn n(&self) -> usize {
        self.mechanism.dof()
    }

    fn put(&mut self, name: &str, values: impl IntoIterator<Item = R>) {
        self.found.insert(name.to_string(), values.into_iter().map(|x| x.value()).collect());
    }

    fn put_wide(&mut self, name: &str, values: &[Wide]) {
        self.found.insert(name.to_string(), values.iter().map(|x| x.value()).collect());
    }

    /// Without constraints M is eliminated where it stands, and what is not coupled does not disturb each other.
    fn noise(&self) -> fn() -> f64 {
        if self.mechanism.rows.is_empty() { || 0.0 } else { R::noise }
    }

    fn put_rows(&mut self, name: &str, rows: &[Vec<R>]) {
        self.put(name, rows.iter().flatten().copied());
    }

    fn rows<'e, S: Real>(&self, equations: &'e Equations<S>) -> Vec<(&'e Component<S>, bool)> {
        self.mechanism.rows.iter().map(|&(row, holonomic)| (&equations.rows[row], holonomic)).collect()
    }

    /// The equations with a derivative in one direction.
    fn slopes(&self, state: &State<R>, wanted: Wanted, seed: impl FnOnce(&mut State<Dual<R>>)) -> Slopes<R> {
        let mut lifted = state.map(&mut |x| Dual::fixed(x));
        seed(&mut lifted);
        self.here.equations(&lifted, 0..self.n(), wanted)
    }

    fn measure(&mut self, directions: Option<&Directions>, rank: Option<usize>) -> Result<Rank, String> {
        let (state, n) = (self.state, self.n());
        let here = self.here.equations(state, 0..n, Wanted::Outputs);
        self.put("kinetic_energy", [here.kinetic]);
        self.put("potential_energy", [here.potential]);
        self.put("momentum", here.momentum.clone());
        self.put("dissipation_force", here.dissipation.clone());
        self.put("generalized_force", here.force.clone());
        let sums = here.inertia.iter().zip(&here.dissipation).map(|(&h, &d)| h + d).collect::<Vec<_>>();
        self.put("inverse_dynamics", sums);
        let unaccelerated = State { qdd: vec![R::zero(); n], ..state.clone() };
        let without = self.here.equations(&unaccelerated, 0..n, Wanted::Motion);
        self.put("bias", without.inertia.clone());
        let at_rest = at_rest(state);
        self.put("gravity", self.at_rest.equations(&at_rest, 0..n, Wanted::Inertia).inertia);
        let mass = self.mass(&unaccelerated);
        self.put_rows("mass_matrix", &mass);
        self.constraints(&here, &without);
        self.outputs(&here);
        let rank = self.motion(&mass, &without, directions, rank)?;
        if let Some(directions) = directions {
            if directions.coriolis {
                self.coriolis();
            }
            self.outputs_by_inputs(directions);
            self.jacobians(directions);
        }
        Ok(rank)
    }

    /// `∂(inertia)/∂q̈`, column by column.
    fn mass(&self, state: &State<R>) -> Vec<Vec<R>> {
        let column = |j: usize| {
            let slopes = self.slopes(state, Wanted::Inertia, |state| state.qdd[j].eps = R::of(1.0));
            slopes.inertia.iter().map(|x| x.eps).collect()
        };
        (0..self.n()).map(column).collect()
    }

    /// `C = ½(Ṁ + ∂M/∂t + P − Pᵀ) + (∂aᵢ/∂qⱼ − ∂aⱼ/∂qᵢ)` with `Pᵢⱼ = ∂(M q̇)ᵢ/∂qⱼ` and a the momentum at rest.
    fn coriolis(&mut self) {
        let n = self.n();
        let (passing, explicit) = (self.mass_rate(true), self.mass_rate(false));
        let by_place = |written: &Written, state: &State<R>| -> Vec<Vec<R>> {
            let column = |j: usize| {
                let mut lifted = state.map(&mut |x| Dual::fixed(x));
                lifted.q[j].eps = R::of(1.0);
                let slopes = written.equations(&lifted, 0..n, Wanted::Inertia);
                slopes.momentum.iter().map(|x| x.eps).collect()
            };
            (0..n).map(column).collect()
        };
        let all = by_place(&self.here, self.state);
        let gyroscopic = by_place(&self.at_rest, &at_rest(self.state));
        let half = R::of(0.5);
        let entry = |i: usize, j: usize| {
            let skew = (all[j][i] - all[i][j]) + (gyroscopic[j][i] - gyroscopic[i][j]);
            half * (passing[j][i] + explicit[j][i] + skew)
        };
        let values: Vec<R> = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect();
        self.put("coriolis_matrix", values);
    }

    /// Columns of Ṁ along the motion, or of `∂M/∂t` while the coordinates stay.
    fn mass_rate(&self, moving: bool) -> Vec<Vec<R>> {
        let one = R::of(1.0);
        let column = |j: usize| {
            let mut state = along(self.state, moving).map(&mut |x| Dual::fixed(x));
            // The direction of the acceleration is the outer one.
            state.qdd[j].eps = Dual::fixed(one);
            let slopes = self.here.equations(&state, 0..self.n(), Wanted::Inertia);
            slopes.inertia.iter().map(|x| x.eps.eps).collect()
        };
        (0..self.n()).map(column).collect()
    }

    fn constraints(&mut self, here: &Equations<R>, without: &Equations<R>) {
        if self.mechanism.rows.is_empty() {
            return;
        }
        let rows = self.rows(here);
        let value = rows.iter().map(|(row, _)| row.along[0]).collect::<Vec<_>>();
        let rate = rows.iter().map(|(row, holonomic)| row.rate(*holonomic)).collect::<Vec<_>>();
        let gradients = rows.iter().flat_map(|(row, holonomic)| row.gradient(*holonomic).to_vec()).collect::<Vec<_>>();
        let bias = self.rows(without).iter().map(|(row, holonomic)| row.second(*holonomic)).collect::<Vec<_>>();
        self.put("constraint", value);
        self.put("constraint_rate", rate);
        self.put("constraint_jacobian", gradients);
        self.put("constraint_bias", bias);
    }

    fn outputs(&mut self, here: &Equations<R>) {
        if here.outputs.is_empty() {
            return;
        }
        let mut lifted = along(self.state, true);
        lifted.qdd.iter_mut().for_each(|x| *x = Dual::of(0.0));
        let moving = self.here.equations(&lifted, 0..self.n(), Wanted::Outputs);
        let names = self.mechanism.outputs.clone();
        for ((output, moving), name) in here.outputs.iter().zip(&moving.outputs).zip(names) {
            self.put(&name, output.value.clone());
            self.put(&format!("{name}_velocity"), output.velocity.clone());
            self.put_rows(&format!("{name}_jacobian"), &output.jacobian);
            self.put_rows(&format!("{name}_jacobian_qd"), &output.speeds);
            // Where the output has no velocity.
            self.put_rows(&format!("{name}_slope"), &output.slopes);
            let rates: Vec<Vec<R>> = moving.jacobian.iter().map(|row| row.iter().map(|x| x.eps).collect()).collect();
            self.put_rows(&format!("{name}_jacobian_rate"), &rates);
        }
    }

    /// `∂y/∂u`
    fn outputs_by_inputs(&mut self, directions: &Directions) {
        let names = self.mechanism.outputs.clone();
        if names.is_empty() || directions.u.is_empty() {
            return;
        }
        let mut columns: Vec<Vec<Vec<R>>> = vec![Vec::new(); names.len()];
        for &j in &directions.u {
            let slopes = self.slopes(self.state, Wanted::Outputs, |state| state.u[j].eps = R::of(1.0));
            for (columns, output) in columns.iter_mut().zip(&slopes.outputs) {
                columns.push(output.value.iter().map(|y| y.eps).collect());
            }
        }
        for (name, columns) in names.iter().zip(&columns) {
            let height = columns.first().map_or(0, Vec::len);
            let matrix = spread_out(&directions.u, columns, height, count(&self.mechanism.inputs));
            self.put(&format!("{name}_jacobian_u"), matrix);
        }
    }

    /// q̈, λ, the linearization and the wrenches at joints.
    fn motion(
        &mut self,
        mass: &[Vec<R>],
        without: &Equations<R>,
        directions: Option<&Directions>,
        rank: Option<usize>,
    ) -> Result<Rank, String> {
        let n = self.n();
        let rows = self.rows(without);
        let bordered = bordered(mass, &rows);
        let resting = State { qdd: vec![R::zero(); n], ..self.state.clone() };
        let right = each_by_itself::<R>(|again| {
            let other = again.then(|| self.here.equations(&resting, 0..n, Wanted::Motion));
            let equations = other.as_ref().unwrap_or(without);
            let rest = (0..n).map(|i| (equations.force[i] - equations.inertia[i] - equations.dissipation[i]).wide());
            let rows = self.rows(equations);
            rest.chain(rows.iter().map(|(row, holonomic)| -row.second(*holonomic).wide())).collect()
        });
        let solution = solve(&bordered, &[right], self.threshold, rank, self.noise());
        let (qdd, minus) = solution.columns[0].split_at(n);
        let multipliers: Vec<Wide> = minus.iter().map(|l| -*l).collect();
        self.put_wide("forward_dynamics", qdd);
        self.put_wide("multipliers", &multipliers);
        let forces = (0..n).map(|i| {
            let terms = rows.iter().zip(&multipliers);
            terms.fold(Wide::from(0.0), |sum, ((row, holonomic), l)| sum + row.gradient(*holonomic)[i].wide() * *l)
        });
        let forces: Vec<Wide> = forces.collect();
        self.put_wide("constraint_force", &forces);
        let of_rows = rank_of(&bordered, n, self.threshold);
        let rank = Rank {
            found: solution.rank,
            full: n + rows.len(),
            regular: solution.rank == n + of_rows.rank / 2,
            clear: solution.clear && of_rows.clear,
            contradictory: solution.contradictory,
            may_have_no_answer: solution.least <= WITHOUT_INERTIA * n as f64 || !of_rows.clear,
            has_component_near_zero: self.has_component_near_zero(&rows),
        };
        if let Some(directions) = directions
            && rank.found == rank.full
        {
            self.linearize(directions, &bordered, qdd, &multipliers);
        }
        self.wrenches(&multipliers)?;
        Ok(rank)
    }

    /// Whether a component of a constraint is less than `HELD` of the others by each coordinate: as its vector is known
    /// to rounding, it may be none.
    fn has_component_near_zero(&self, rows: &[(&Component<R>, bool)]) -> bool {
        let slopes: Vec<Vec<f64>> = rows
            .iter()
            .map(|(row, holonomic)| wide(row.gradient(*holonomic)).iter().map(|x| x.value().abs()).collect())
            .collect();
        let vectors = &self.mechanism.vectors;
        let greatest = |k: usize, i: usize| {
            let vector = slopes.iter().zip(vectors).filter(|(_, vector)| **vector == vectors[k]);
            vector.fold(0.0_f64, |greatest, (row, _)| greatest.max(row[i]))
        };
        let is_small = |k: usize| slopes[k].iter().enumerate().all(|(i, &x)| x <= HELD * greatest(k, i));
        (0..slopes.len()).any(is_small)
    }

    /// What the auxiliary coordinates of the joints have to be held with, at the accelerations of the state.
    fn wrenches(&mut self, multipliers: &[Wide]) -> Result<(), String> {
        let (n, joints) = (self.n(), self.mechanism.joints.clone());
        if joints.is_empty() {
            return Ok(());
        }
        let mut state = self.state.clone();
        for list in [&mut state.q, &mut state.qd, &mut state.qdd] {
            list.resize(n + 6 * joints.len(), R::zero());
        }
        let held = Written::at(self.mechanism, &state)?.equations(&state, n..state.q.len(), Wanted::Motion);
        let rows = self.rows(&held);
        let along = |i: usize| {
            let terms = rows.iter().zip(multipliers);
            terms.fold(R::zero(), |sum, ((row, holonomic), l)| sum + row.gradient(*holonomic)[i] * R::exact(*l))
        };
        let wrench = |i: usize| held.inertia[i] + held.dissipation[i] - held.force[i] - along(i);
        let mut found: BTreeMap<String, Vec<(usize, Vec<f64>)>> = BTreeMap::new();
        for (k, (name, index)) in joints.iter().enumerate() {
            let values = (6 * k..6 * k + 6).map(|i| wrench(i).value()).collect();
            found.entry(name.to_string()).or_default().push((*index, values));
        }
        for (name, mut wrenches) in found {
            wrenches.sort_by_key(|(index, _)| *index);
            self.found.insert(name, wrenches.into_iter().flat_map(|(_, values)| values).collect());
        }
        Ok(())
    }

    /// `∂q̈/∂z` from what the equations of motion lose when z changes while q̈ and λ stay.
    fn linearize(&mut self, directions: &Directions, bordered: &[Vec<Wide>], qdd: &[Wide], multipliers: &[Wide]) {
        let n = self.n();
        let moving = State { qdd: qdd.iter().map(|&x| R::exact(x)).collect(), ..self.state.clone() };
        let once = |seed: &dyn Fn(&mut State<Dual<R>>)| -> Vec<Wide> {
            let slopes = self.slopes(&moving, Wanted::Motion, seed);
            let rows = self.rows(&slopes);
            let lost = (0..n).map(|i| {
                let own = (slopes.force[i] - slopes.inertia[i] - slopes.dissipation[i]).eps.wide();
                let terms = rows.iter().zip(multipliers);
                terms.fold(own, |sum, ((row, holonomic), l)| sum + row.gradient(*holonomic)[i].eps.wide() * *l)
            });
            lost.chain(rows.iter().map(|(row, holonomic)| -row.second(*holonomic).eps.wide())).collect()
        };
        let changes = |seed: &dyn Fn(&mut State<Dual<R>>)| each_by_itself::<R>(|_| once(seed));
        let one = R::of(1.0);
        let mut right = Vec::new();
        for &j in &directions.q {
            right.push(changes(&|state| state.q[j].eps = one));
        }
        for &j in &directions.qd {
            right.push(changes(&|state| state.qd[j].eps = one));
        }
        for &j in &directions.u {
            right.push(changes(&|state| state.u[j].eps = one));
        }
        for &j in &directions.parameters {
            right.push(changes(&|state| state.parameters[j].eps = one));
        }
        let solution = solve(bordered, &right, 0.0, None, self.noise());
        let mut columns = solution.columns.iter().map(|column| &column[..n]);
        let mut part = |wanted: &[usize], count: usize| {
            let columns: Vec<&[Wide]> = columns.by_ref().take(wanted.len()).collect();
            spread_out(wanted, &columns, n, count).iter().map(|x| x.value()).collect::<Vec<f64>>()
        };
        let Directions { q, qd, u, parameters, .. } = directions;
        let parts = [part(q, n), part(qd, n), part(u, count(&self.mechanism.inputs))].concat();
        let by_parameters = part(parameters, self.state.parameters.len());
        self.found.insert("linearize".to_string(), parts);
        self.found.insert("linearize_parameters".to_string(), by_parameters);
    }

    /// `∂τ/∂q`, `∂τ/∂q̇`, and `∂(A q̇ + b)/∂q`.
    fn jacobians(&mut self, directions: &Directions) {
        let (n, one) = (self.n(), R::of(1.0));
        let (mut by_place, mut by_rate, mut rows) = (Vec::new(), Vec::new(), Vec::new());
        let torque = |slopes: &Slopes<R>| -> Vec<R> {
            slopes.inertia.iter().zip(&slopes.dissipation).map(|(h, d)| h.eps + d.eps).collect()
        };
        for &j in &directions.q {
            let slopes = self.slopes(self.state, Wanted::Motion, |state| state.q[j].eps = one);
            by_place.push(torque(&slopes));
            rows.push(self.rows(&slopes).iter().map(|(row, holonomic)| row.rate(*holonomic).eps).collect::<Vec<_>>());
        }
        for &j in &directions.qd {
            let slopes = self.slopes(self.state, Wanted::Motion, |state| state.qd[j].eps = one);
            by_rate.push(torque(&slopes));
        }
        let part = |wanted: &[usize], columns: &[Vec<R>], height: usize| spread_out(wanted, columns, height, n);
        let torques = [part(&directions.q, &by_place, n), part(&directions.qd, &by_rate, n)].concat();
        self.put("inverse_dynamics_jacobian", torques);
        self.put("constraint_rate_jacobian", part(&directions.q, &rows, self.mechanism.rows.len()));
    }
}

/// Equations of which each is rounded by itself. The referee takes what they have in common from one calculation, whose
/// roundings would cancel where the solution is a difference of equations; generated functions write each equation out,
/// and round alike only what is alike. So each is somewhere between two calculations: `calculate(true)` is the second.
fn each_by_itself<R: Real>(calculate: impl Fn(bool) -> Vec<Wide>) -> Vec<Wide> {
    let mut found = calculate(false);
    if R::ROUGH {
        let again = calculate(true);
        found.iter_mut().zip(again).for_each(|(a, b)| *a = *a + (b - *a) * Wide::from(R::share()));
    }
    found
}

/// A matrix of this height and this many columns, row by row, of which only the wanted columns are known.
fn spread_out<R: Real, C: AsRef<[R]>>(wanted: &[usize], columns: &[C], height: usize, count: usize) -> Vec<R> {
    let mut matrix = vec![R::of(NOT_WANTED); height * count];
    for (&j, column) in wanted.iter().zip(columns) {
        column.as_ref().iter().enumerate().for_each(|(i, &entry)| matrix[i * count + j] = entry);
    }
    matrix
}

/// Twice the rank of A: that of the bordered matrix without M.
fn rank_of(bordered: &[Vec<Wide>], n: usize, threshold: f64) -> Solution {
    let mut border = bordered.to_vec();
    border.iter_mut().take(n).for_each(|row| row[..n].fill(Wide::from(0.0)));
    solve(&border, &[], threshold, None, || 0.0)
}

/// M, bordered by the rows of A.
fn bordered<R: Base>(mass: &[Vec<R>], rows: &[(&Component<R>, bool)]) -> Vec<Vec<Wide>> {
    let n = mass.len();
    let size = n + rows.len();
    let mut matrix = vec![vec![Wide::from(0.0); size]; size];
    for (j, column) in mass.iter().enumerate() {
        for (i, entry) in wide(column).into_iter().enumerate() {
            matrix[i][j] = entry;
        }
    }
    for (k, (row, holonomic)) in rows.iter().enumerate() {
        for (j, entry) in wide(row.gradient(*holonomic)).into_iter().enumerate() {
            matrix[n + k][j] = entry;
            matrix[j][n + k] = entry;
        }
    }
    matrix
}

/// The state and how it changes: along the motion, or by the time alone.
fn along<R: Real>(state: &State<R>, moving: bool) -> State<Dual<R>> {
    let mut lifted = state.map(&mut |x| Dual::fixed(x));
    lifted.t.eps = R::of(1.0);
    for signal in &mut lifted.prescribed {
        signal[0].eps = signal[1].re;
        signal[1].eps = signal[2].re;
    }
    if moving {
        lifted.q.iter_mut().zip(&state.qd).for_each(|(q, rate)| q.eps = *rate);
    }
    lifted
}
