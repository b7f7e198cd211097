use super::*;

/// Two points of masses 1 and 3 in a plane, joined by a rod of length 1; the first one is on the line y = x/2 + t.
struct Rod {
    /// The rod once more.
    twice: bool,
    /// How much longer the second rod is.
    misfit: f64,
}

impl Constraints<f64> for Rod {
    fn rows(&self) -> usize {
        if self.twice { 3 } else { 2 }
    }
    fn is_holonomic(&self, _: usize) -> bool {
        true
    }
    fn mass_matrix(&self, _: f64, _: &[f64], m: &mut [f64]) {
        m.fill(0.0);
        [1.0, 1.0, 3.0, 3.0].into_iter().enumerate().for_each(|(i, mass)| m[5 * i] = mass);
    }
    fn position(&self, t: f64, q: &[f64], phi: &mut [f64]) {
        let [dx, dy] = [q[2] - q[0], q[3] - q[1]];
        let rod = dx * dx + dy * dy - 1.0;
        phi[..2].copy_from_slice(&[rod, q[1] - q[0] / 2.0 - t]);
        phi[2..].iter_mut().for_each(|phi| *phi = 2.0 * rod - self.misfit);
    }
    fn rate(&self, t: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
        let mut a = [0.0; 12];
        self.jacobian(t, q, &mut a[..4 * self.rows()]);
        for (row, rate) in rate.iter_mut().enumerate() {
            *rate = (0..4).map(|i| a[4 * row + i] * qd[i]).sum::<f64>() - if row == 1 { 1.0 } else { 0.0 };
        }
    }
    fn jacobian(&self, _: f64, q: &[f64], a: &mut [f64]) {
        let [dx, dy] = [2.0 * (q[2] - q[0]), 2.0 * (q[3] - q[1])];
        a[..8].copy_from_slice(&[-dx, -dy, dx, dy, -0.5, 1.0, 0.0, 0.0]);
        let twice = [-2.0 * dx, -2.0 * dy, 2.0 * dx, 2.0 * dy];
        a[8..].iter_mut().zip(twice).for_each(|(a, value)| *a = value);
    }
}

/// The rod, which finds least changes itself, and counts how often.
struct Finder {
    rod: Rod,
    found: core::cell::Cell<usize>,
}

impl Constraints<f64> for Finder {
    fn rows(&self) -> usize {
        self.rod.rows()
    }
    fn is_holonomic(&self, row: usize) -> bool {
        self.rod.is_holonomic(row)
    }
    fn mass_matrix(&self, t: f64, q: &[f64], m: &mut [f64]) {
        self.rod.mass_matrix(t, q, m);
    }
    fn position(&self, t: f64, q: &[f64], phi: &mut [f64]) {
        self.rod.position(t, q, phi);
    }
    fn rate(&self, t: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
        self.rod.rate(t, q, qd, rate);
    }
    fn jacobian(&self, t: f64, q: &[f64], a: &mut [f64]) {
        self.rod.jacobian(t, q, a);
    }
    fn least_change(&self, t: f64, q: &[f64], target: &[f64], change: &mut [f64]) -> Option<usize> {
        let (mut m, mut a) = ([[0.0; 4]; 4], [[0.0; 4]; 2]);
        self.mass_matrix(t, q, m.as_flattened_mut());
        Rod { twice: false, misfit: 0.0 }.jacobian(t, q, a.as_flattened_mut());
        let (found, _) = crate::constrained_solve(m, a, [0.0; 4], [target[0], target[1]]);
        change.copy_from_slice(&found);
        self.found.set(self.found.get() + 1);
        Some(2)
    }
}

#[test]
fn a_mechanism_may_find_least_changes_itself() {
    for twice in [false, true] {
        let finder = Finder { rod: Rod { twice, misfit: 0.0 }, found: core::cell::Cell::new(0) };
        let project = |finds: bool, redundant_rows| {
            let (mut state, mut projector) = (GUESS, Projector::new([0.0; MEMORY]));
            projector.redundant_rows = redundant_rows;
            let end = match finds {
                true => projector.project(&finder, 0.5, &mut state),
                false => projector.project(&finder.rod, 0.5, &mut state),
            };
            end.map(|()| state)
        };
        let [found, expected] = [true, false].map(|finds| project(finds, RedundantRows::LeaveOut).unwrap());
        let all = |state: State<[f64; 4]>| state.q.into_iter().chain(state.qd);
        for (found, expected) in all(found).zip(all(expected)) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
        assert!(finder.found.get() > 3);
        // Rows that depend on others are refused, whoever finds the change.
        let refused = [true, false].map(|finds| project(finds, RedundantRows::Refuse).is_err());
        assert_eq!(refused, [twice; 2]);
        let mut named = 0;
        let rank = Projector::new([0.0; MEMORY]).rank(&finder, 0.5, &found.q, |_| named += 1);
        assert_eq!((rank, named), (Ok(2), usize::from(twice)));
    }
}

/// A point that stays on the x axis, however fast along it.
struct Rail;

impl Constraints<f64> for Rail {
    fn rows(&self) -> usize {
        1
    }
    fn is_holonomic(&self, _: usize) -> bool {
        true
    }
    fn mass_matrix(&self, _: f64, _: &[f64], m: &mut [f64]) {
        m.copy_from_slice(&[1.0, 0.0, 0.0, 1.0]);
    }
    fn position(&self, _: f64, q: &[f64], phi: &mut [f64]) {
        phi[0] = 4.0 * q[1];
    }
    fn rate(&self, _: f64, _: &[f64], qd: &[f64], rate: &mut [f64]) {
        rate[0] = 4.0 * qd[1];
    }
    fn jacobian(&self, _: f64, _: &[f64], a: &mut [f64]) {
        a.copy_from_slice(&[0.0, 4.0]);
    }
}

const MEMORY: usize = Projector::<f64, [f64; 0]>::size(4, 3);
const GUESS: State<[f64; 4]> = State::new([0.1, 0.3, 0.8, 1.2], [1.0, -1.0, 0.5, 0.25]);

fn largest(rod: &Rod, t: f64, state: &State<[f64; 4]>) -> f64 {
    let (mut phi, mut rate) = ([0.0; 3], [0.0; 3]);
    let rows = rod.rows();
    rod.position(t, &state.q, &mut phi[..rows]);
    rod.rate(t, &state.q, &state.qd, &mut rate[..rows]);
    phi.iter().chain(&rate).fold(0.0, |largest, x| largest.max(x.abs()))
}

#[test]
fn projected_states_are_on_the_constraints() {
    let rod = Rod { twice: false, misfit: 0.0 };
    let mut projector = Projector::new([0.0; MEMORY]);
    let mut state = GUESS;
    projector.project(&rod, 0.2, &mut state).unwrap();
    assert!(largest(&rod, 0.2, &state) < 1e-15, "{state:?}");
    // What was taken away is a force of the constraints: M δq̇ = Aᵀ λ.
    let mut a = [0.0; 8];
    rod.jacobian(0.2, &state.q, &mut a);
    let change: [f64; 4] = core::array::from_fn(|i| [1.0, 1.0, 3.0, 3.0][i] * (state.qd[i] - GUESS.qd[i]));
    let first = change[2] / a[2];
    let second = (change[0] - first * a[0]) / a[4];
    assert!((change[3] - first * a[3]).abs() < 1e-14);
    assert!((change[1] - first * a[1] - second * a[5]).abs() < 1e-14);
}

#[test]
fn held_coordinates_stay() {
    let rod = Rod { twice: false, misfit: 0.0 };
    let mut state = GUESS;
    Projector::new([0.0; MEMORY]).assemble(&rod, 0.2, &mut state, |i| i == 0 || i == 2).unwrap();
    assert!(largest(&rod, 0.2, &state) < 1e-15, "{state:?}");
    assert_eq!([state.q[0], state.q[2], state.qd[0], state.qd[2]], [0.1, 0.8, 1.0, 0.5]);
}

/// A position and the velocity of another coordinate.
#[test]
fn positions_and_velocities_are_held_separately() {
    let rod = Rod { twice: false, misfit: 0.0 };
    let mut state = GUESS;
    let mut projector = Projector::new([0.0; MEMORY]);
    projector.assemble_separately(&rod, 0.2, &mut state, |i| i == 2, |i| i == 0).unwrap();
    assert!(largest(&rod, 0.2, &state) < 1e-15, "{state:?}");
    assert_eq!([state.q[2], state.qd[0]], [0.8, 1.0]);
    assert!(state.q[0] != 0.1 && state.qd[2] != 0.5, "{state:?}");
}

/// Where both rods would be of the same direction, Newton's method has no direct way.
#[test]
fn a_guess_where_rows_depend_on_each_other_will_do() {
    // From the centre of its circle, and nearly, the second point goes out by one length, not by ten thousand.
    let rod = Rod { twice: false, misfit: 0.0 };
    let mut projector = Projector::new([0.0; MEMORY]);
    for off in [1e-3, 1e-7, 1e-12] {
        let mut state = State::new([0.0, 0.0, off, 0.0], [0.0, 1.0, 0.0, 0.0]);
        projector.assemble(&rod, 0.0, &mut state, |i| i < 2).unwrap();
        assert!(largest(&rod, 0.0, &state) < 1e-15 && (state.q[2] - 1.0).abs() < 1e-15, "{state:?}");
    }
    // At the centre itself there is no way to tell where: it stays open.
    let open = projector.assemble(&rod, 0.0, &mut State::new([0.0; 4], [0.0; 4]), |i| i < 2);
    assert_eq!(open, Err(ConstraintError::Open { row: 0, residual: -1.0 }));
    // From afar.
    let mut state = State::new([0.0, 0.0, 1e12, 0.0], [0.0, 1.0, 0.0, 0.0]);
    projector.assemble(&rod, 0.0, &mut state, |i| i < 2).unwrap();
    assert!((state.q[2] - 1.0).abs() < 1e-15);
}

/// What is held may leave nothing to a row; it may be satisfied all the same.
#[test]
fn a_state_that_is_held_whole_is_checked() {
    let rod = Rod { twice: false, misfit: 0.0 };
    let mut projector = Projector::new([0.0; MEMORY]);
    let mut good = GUESS;
    projector.project(&rod, 0.2, &mut good).unwrap();
    let mut held = good;
    projector.assemble(&rod, 0.2, &mut held, |_| true).unwrap();
    assert_eq!(held, good);
    let open = projector.assemble(&rod, 0.2, &mut GUESS.clone(), |_| true);
    assert!(
        matches!(open, Err(ConstraintError::Open { row: 0, residual }) if (residual - 0.3).abs() < 1e-12),
        "{open:?}"
    );
    let fast = projector.assemble(&rod, 0.2, &mut State::new(good.q, GUESS.qd), |_| true);
    assert!(matches!(fast, Err(ConstraintError::Contradiction { .. })), "{fast:?}");
    // Rows that depend on each other whatever is held are refused.
    let refused = projector.assemble(&Rod { twice: true, misfit: 0.0 }, 0.2, &mut good, |_| true);
    assert!(matches!(refused, Err(ConstraintError::Redundant { row: 0 | 2 })), "{refused:?}");
}

#[test]
fn redundant_rows_are_named_or_left_out() {
    let rod = Rod { twice: true, misfit: 0.0 };
    let mut state = GUESS;
    let refused = Projector::new([0.0; MEMORY]).project(&rod, 0.2, &mut state);
    assert!(matches!(refused, Err(ConstraintError::Redundant { row: 0 | 2 })), "{refused:?}");
    assert_eq!(state, GUESS);
    let mut projector = Projector::new([0.0; MEMORY]).with_redundant_rows(RedundantRows::LeaveOut);
    projector.project(&rod, 0.2, &mut state).unwrap();
    assert!(largest(&rod, 0.2, &state) < 1e-15, "{state:?}");
}

#[test]
fn redundant_rows_share_their_multiplier() {
    let (q, force) = ([0.1, 0.3, 0.7, 1.1], [1.0, -2.0, 0.5, 3.0]);
    let solve = |twice: bool| {
        let rod = Rod { twice, misfit: 0.0 };
        let (rows, bias) = (rod.rows(), [0.25, -1.0, 0.5]);
        let (mut qdd, mut multipliers) = ([0.0; 4], [0.0; 3]);
        let mut projector = Projector::new([0.0; MEMORY]).with_redundant_rows(RedundantRows::LeaveOut);
        assert_eq!(projector.rank(&rod, 0.0, &q, |row| assert!(row != 1)), Ok(2));
        let multiplier = &mut multipliers[..rows];
        projector.accelerations(&rod, 0.0, &q, &force, &bias[..rows], &mut qdd, multiplier).unwrap();
        let mut a = [0.0; 12];
        rod.jacobian(0.0, &q, &mut a[..4 * rows]);
        for i in 0..4 {
            let reaction: f64 = (0..rows).map(|row| a[4 * row + i] * multipliers[row]).sum();
            assert!(([1.0, 1.0, 3.0, 3.0][i] * qdd[i] - force[i] - reaction).abs() < 1e-14);
        }
        for row in 0..rows {
            let along: f64 = (0..4).map(|i| a[4 * row + i] * qdd[i]).sum();
            assert!((along + bias[row]).abs() < 1e-14);
        }
        (qdd, multipliers)
    };
    let ((once, one), (twice, two)) = (solve(false), solve(true));
    assert!(once.iter().zip(&twice).all(|(a, b)| (a - b).abs() < 1e-14), "{once:?} {twice:?}");
    // λ₀ + 2 λ₂ is given; its squares are least where λ₂ = 2 λ₀.
    let expected = [one[0] / 5.0, one[1], 2.0 * one[0] / 5.0];
    assert!(expected.iter().zip(&two).all(|(a, b)| (a - b).abs() < 1e-14), "{one:?} {two:?}");
    let mut refusing = Projector::new([0.0; MEMORY]);
    let (rod, mut qdd, mut multipliers) = (Rod { twice: true, misfit: 0.0 }, [0.0; 4], [0.0; 3]);
    let refused = refusing.accelerations(&rod, 0.0, &q, &force, &[0.0; 3], &mut qdd, &mut multipliers);
    assert!(matches!(refused, Err(ConstraintError::Redundant { row: 0 | 2 })), "{refused:?}");
}

/// x + y is held, twice in units of the rows; z is in the rows by rounding alone.
#[derive(Debug)]
struct Plane {
    unit: f64,
    rounding: [f64; 2],
}

impl Constraints<f64> for Plane {
    fn rows(&self) -> usize {
        2
    }
    fn is_holonomic(&self, _: usize) -> bool {
        true
    }
    fn mass_matrix(&self, _: f64, _: &[f64], m: &mut [f64]) {
        m.copy_from_slice(&[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 4.0]);
    }
    fn position(&self, _: f64, q: &[f64], phi: &mut [f64]) {
        phi.fill(self.unit * (q[0] + q[1]));
    }
    fn rate(&self, _: f64, _: &[f64], qd: &[f64], rate: &mut [f64]) {
        rate.fill(self.unit * (qd[0] + qd[1]));
    }
    fn jacobian(&self, _: f64, _: &[f64], a: &mut [f64]) {
        let [first, second] = self.rounding;
        a.copy_from_slice(&[1.0, 1.0, first, 1.0, 1.0, second].map(|x| self.unit * x));
    }
}

#[test]
fn rounding_says_nothing_of_multipliers() {
    for unit in [1e-30, 1e-3, 1.0, 1e30] {
        for rounding in [[0.0, 0.0], [1e-17, -3e-17], [-2e-16, 1e-16], [1e-300, 0.0], [0.0, 1e-16]] {
            let plane = Plane { unit, rounding };
            let (mut qdd, mut multipliers) = ([0.0; 3], [0.0; 2]);
            let mut projector = Projector::new([0.0; MEMORY]).with_redundant_rows(RedundantRows::LeaveOut);
            let force = [3.0, 0.0, 0.5];
            projector.accelerations(&plane, 0.0, &[0.0; 3], &force, &[0.0; 2], &mut qdd, &mut multipliers).unwrap();
            // ẍ = −ÿ = 1, and the rows share −2 alike.
            assert!([1.0, -1.0, 0.125].iter().zip(qdd).all(|(a, b)| (a - b).abs() < 1e-14), "{plane:?} {qdd:?}");
            let apart = multipliers.map(|l| (l * unit + 1.0).abs());
            assert!(apart.iter().all(|&apart| apart < 1e-14), "{plane:?} {multipliers:?}");
        }
    }
}

/// A free body of this inertia, its attitude a quaternion: M has rank 3, `M = 4 s Gᵀ J G`; and next to it, where the
/// first of two coordinates about one axis has lost its own inertia, two angles tied to a third.
struct Small {
    size: f64,
    own: f64,
}

impl Constraints<f64> for Small {
    fn rows(&self) -> usize {
        2
    }
    fn is_holonomic(&self, _: usize) -> bool {
        true
    }
    fn mass_matrix(&self, _: f64, q: &[f64], m: &mut [f64]) {
        m.fill(0.0);
        let e = &q[..4];
        let g = [[-e[1], e[0], e[3], -e[2]], [-e[2], -e[3], e[0], e[1]], [-e[3], e[2], -e[1], e[0]]];
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            m[7 * i + j] = (0..3).map(|k| 4.0 * self.size * [1.0, 2.0, 3.0][k] * g[k][i] * g[k][j]).sum();
        }
        for (i, j) in (0..2).flat_map(|i| (0..2).map(move |j| (i, j))) {
            m[7 * (4 + i) + 4 + j] = 1.1 * [0.7, 0.3][i] * [0.7, 0.3][j];
        }
        m[7 * 5 + 5] += self.own;
        m[7 * 6 + 6] = 1.0;
    }
    fn position(&self, _: f64, q: &[f64], phi: &mut [f64]) {
        phi[0] = q[..4].iter().map(|e| e * e).sum::<f64>() - 1.0;
        phi[1] = 2.0 * q[5] + 3.0 * q[6] - 1.0;
    }
    fn rate(&self, t: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
        let mut a = [0.0; 14];
        self.jacobian(t, q, &mut a);
        (0..2).for_each(|row| rate[row] = (0..7).map(|i| a[7 * row + i] * qd[i]).sum());
    }
    fn jacobian(&self, _: f64, q: &[f64], a: &mut [f64]) {
        a.fill(0.0);
        (0..4).for_each(|i| a[i] = 2.0 * q[i]);
        (a[7 + 5], a[7 + 6]) = (2.0, 3.0);
    }
}

#[test]
fn inertias_of_all_sizes_are_alike() {
    let q = [0.5, -0.1, 0.7, 0.5, 1e-9, 0.5, 0.0];
    let solve = |size: f64, own: f64| {
        let (mut qdd, mut multipliers) = ([0.0; 7], [0.0; 2]);
        let force = [0.3 * size, -0.2 * size, 0.9 * size, 0.1 * size, 1.0, 0.0, 1.0];
        let mut projector = Projector::new([0.0; Projector::<f64, [f64; 0]>::size(7, 2)]);
        let small = Small { size, own };
        projector.accelerations(&small, 0.0, &q, &force, &[-0.4, 0.0], &mut qdd, &mut multipliers).unwrap();
        let mut state = State::new(q.map(|q| q + 0.1), [0.1; 7]);
        projector.project(&small, 0.0, &mut state).unwrap();
        (qdd, multipliers[0] / size, multipliers[1], state)
    };
    let (expected, unit, row, state) = solve(1.0, 1e-18);
    // By hand: ä = (1 + 1.5·0.231 c̈)/0.539, b̈ = −1.5 c̈, c̈ = 1 + 1.5·0.231/0.539.
    for (found, expected) in expected[4..].iter().zip([2.911_410_018_6, -2.464_285_714_3, 1.642_857_142_9]) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    for (size, own) in [(1e-18, 0.0), (1e-9, 1e-18), (1e12, 1e-17), (1e-3, 1e-15)] {
        let (found, other_unit, other_row, other) = solve(size, own);
        for i in 0..7 {
            assert!((found[i] - expected[i]).abs() < 1e-13, "{size:e}: {found:?} {expected:?}");
            assert!((other.q[i] - state.q[i]).abs() < 1e-12 && (other.qd[i] - state.qd[i]).abs() < 1e-12);
        }
        assert!((other_unit - unit).abs() < 1e-13 && (other_row - row).abs() < 1e-13);
    }
}

/// The third row is twice the first one; what it asks for is not twice what that does.
#[test]
fn accelerations_that_rows_contradict_are_refused() {
    let rod = Rod { twice: true, misfit: 0.0 };
    let accelerations = |q: [f64; 4], force: [f64; 4], bias: [f64; 3]| {
        let (mut qdd, mut multipliers) = ([0.0; 4], [0.0; 3]);
        let mut projector = Projector::new([0.0; MEMORY]).with_redundant_rows(RedundantRows::LeaveOut);
        projector.accelerations(&rod, 0.0, &q, &force, &bias, &mut qdd, &mut multipliers)
    };
    let (q, force) = ([0.1, 0.3, 0.7, 1.1], [1.0, -2.0, 0.5, 3.0]);
    for size in [1e-6, 1.0, 1e6] {
        let scaled = |bias: [f64; 3]| accelerations(q, force.map(|f| size * f), bias.map(|b| size * b));
        assert_eq!(scaled([0.25, -1.0, 0.5]), Ok(()));
        assert_eq!(scaled([0.25, -1.0, 0.5 + 1e-13]), Ok(()));
        // Whichever of the two is left out: 0.5 of the third row or −0.25 of the first one.
        for wrong in [[0.25, -1.0, 1.0], [0.0, -1.0, 0.5]] {
            let found = scaled(wrong);
            let left = |row: usize| size * if row == 0 { wrong[0] - wrong[2] / 2.0 } else { wrong[2] - 2.0 * wrong[0] };
            assert!(
                matches!(found, Err(ConstraintError::Contradiction { row: row @ (0 | 2), residual })
                    if (residual - left(row)).abs() < 1e-12 * size),
                "{found:?}"
            );
        }
        assert!(scaled([0.25, -1.0, 0.5 + 1e-4]).is_err());
    }
    // At rest, where a stabilized row is nothing but rounding.
    assert_eq!(accelerations(q, [0.0; 4], [0.0, 0.0, 1e-14]), Ok(()));
    assert!(accelerations(q, [0.0; 4], [0.0, 0.0, 1e-9]).is_err());
}

#[test]
fn forces_that_are_no_numbers_are_refused() {
    let rod = Rod { twice: false, misfit: 0.0 };
    for force in [[f64::INFINITY, 0.0, 0.0, 0.0], [0.0, 0.0, f64::NAN, 0.0], [f64::MAX; 4]] {
        let (q, mut qdd, mut multipliers) = ([0.0, 0.0, 1.0, 0.0], [0.0; 4], [0.0; 2]);
        let mut projector = Projector::new([0.0; MEMORY]);
        let found = projector.accelerations(&rod, 0.0, &q, &force, &[0.0; 2], &mut qdd, &mut multipliers);
        assert_eq!(found, Err(ConstraintError::NonFinite), "{force:?}");
    }
    // Along the rail, where no row feels it.
    let (force, mut qdd, mut multiplier) = ([f64::INFINITY, 0.0], [0.0; 2], [0.0]);
    let mut projector = Projector::new([0.0; 64]);
    let along = projector.accelerations(&Rail, 0.0, &[0.0; 2], &force, &[0.0], &mut qdd, &mut multiplier);
    assert_eq!(along, Err(ConstraintError::NonFinite));
}

#[test]
fn what_does_not_close_is_said() {
    let mut projector = Projector::new([0.0; MEMORY]).with_redundant_rows(RedundantRows::LeaveOut);
    let contradiction = projector.project(&Rod { twice: true, misfit: 0.5 }, 0.2, &mut GUESS.clone());
    assert!(matches!(contradiction, Err(ConstraintError::Open { row: 0 | 2, .. })), "{contradiction:?}");
    // Both ends held, too far apart.
    let mut state = State::new([0.0, 0.0, 3.0, 0.0], [0.0; 4]);
    let open = projector.assemble(&Rod { twice: false, misfit: 0.0 }, 0.0, &mut state, |i| i % 2 == 0);
    assert!(matches!(open, Err(ConstraintError::Open { row: 0, .. })), "{open:?}");
    for mut state in [State::new([f64::NAN; 4], [0.0; 4]), State::new(GUESS.q, [0.0, 0.0, 0.0, f64::INFINITY])] {
        let refused = projector.project(&Rod { twice: false, misfit: 0.0 }, 0.0, &mut state);
        assert_eq!(refused, Err(ConstraintError::NonFinite));
    }
    // A velocity that no row knows, and velocities whose change leads out of the numbers.
    for [along, across] in [[f64::NAN, 0.0], [f64::INFINITY, 0.0], [0.0, f64::MAX]] {
        let mut state = State::new([0.0, 0.0], [along, across]);
        let refused = Projector::new([0.0; 64]).project(&Rail, 0.0, &mut state);
        assert_eq!(refused, Err(ConstraintError::NonFinite), "{along} {across}");
    }
}
