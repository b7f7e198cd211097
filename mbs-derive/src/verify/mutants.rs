//! Programs that are wrong, and must be refused.

use std::collections::BTreeSet;

use super::{Failure, Proof};
use crate::catalogue::{FunctionKind as Kind, names, names_of_output};
use crate::expr::{Function, Graph, Number, Symbol};
use crate::model::Lagrangian;
use crate::optimise::{Derivation, Instruction, Program, Value};

/// What the proof says of a mechanism whose Programs have been changed.
fn proof(text: &str, change: impl FnOnce(&mut Derivation)) -> Result<Proof, Failure> {
    with_mechanism(text, |lagrangian| {
        let mut derivation = crate::derived(lagrangian);
        change(&mut derivation);
        Proof::of(lagrangian, &derivation)
    })
}

fn with_mechanism<T>(text: &str, look: impl FnOnce(&Lagrangian<'_>) -> T) -> T {
    let graph = Graph::verbatim();
    let declared = crate::declared(text, &graph, &[]);
    look(&declared.unwrap_or_else(|errors| panic!("{}", errors.render("mutant.mbs", text))).0)
}

fn refused(text: &str, claim: &str, change: impl FnOnce(&mut Derivation)) {
    match proof(text, change) {
        Err(Failure::Disagreement { claim: found, .. }) => assert!(found.starts_with(claim), "{found}"),
        other => panic!("{claim}: {other:?}"),
    }
}

fn program(derivation: &mut Derivation, kind: Kind) -> &mut Program {
    let function = derivation.altered().functions.iter_mut().find(|function| function.kind == kind);
    &mut function.expect("it is generated").program
}

impl Program {
    fn push(&mut self, instruction: Instruction) -> Value {
        self.instructions.push(instruction);
        Value(self.instructions.len() as u32 - 1)
    }

    /// All results are the inverse cosine of two.
    fn become_undefined(&mut self) {
        let two = self.push(Instruction::Constant(Number::integer(2)));
        let none = self.push(Instruction::Call(Function::Acos, two));
        self.results.iter_mut().for_each(|result| *result = none);
    }
}

const PENDULUM: &str = "#![dimensionless] mechanism A { param g: 1 = 9.81; coord x: 1; coord y: 1; \
    kinetic += 1/2*(2 + cos(x))*dt(x)^2 + dt(x)*dt(y)/3 + dt(y)^2; potential += g*(sin(x) + y^2); force x += sin(y); \
    dissipation += dt(x)^2*y^2; }";

const ROD: &str = "#![dimensionless] mechanism A { coord x: 1; coord y: 1; kinetic += dt(x)^2 + dt(y)^2; \
    potential += 9.81*y; constraint rod: x^2 + y^2 = 1; output place = [x, y, 0]; }";

/// All that a mechanism may have.
const EVERYTHING: &str = "#![dimensionless] mechanism A { param m: 1 = 2; coord x: 1; coord y: 1; coord z: 1; input f: 1; \
    let link = translation([y, z, 0])*rot_z(x); reaction hinge at link; \
    kinetic += m*(dt(x)^2 + dt(y)^2 + dt(z)^2) + particle(m, link.point([1, 0, 0])); potential += y*z; force x += f; \
    constraint rod: y^2 + z^2 = 1; output place = link, jacobian_rate; output power = f*dt(x); }";

/// Whatever is generated is proved: no function may be NaN.
#[test]
fn what_is_not_a_number_proves_nothing() {
    let mut tried = BTreeSet::new();
    for text in [PENDULUM, ROD, EVERYTHING] {
        let functions = with_mechanism(text, |lagrangian| crate::derived(lagrangian).functions.clone());
        for kind in functions.iter().filter(|f| !f.program.results.is_empty()).map(|f| f.kind) {
            let found = proof(text, |derivation| program(derivation, kind).become_undefined());
            assert!(matches!(found, Err(Failure::Disagreement { .. })), "{kind:?}: {found:?}");
            tried.insert(kind.name().to_string());
        }
    }
    let of_output = names_of_output("");
    assert_eq!(tried, names().map(str::to_string).chain(of_output).collect());
}

impl Program {
    /// One result times `1 + 2⁻²⁰`.
    fn stretch(&mut self, result: usize) {
        let factor = self.push(Instruction::Constant(Number::from_f64(1.0 + 2.0_f64.powi(-20)).expect("it is finite")));
        self.results[result] = self.push(Instruction::Mul(self.results[result], factor));
    }
}

/// The rod, declared twice: where it holds, the second row depends on the first.
const TWICE: &str = "#![dimensionless] mechanism A { coord x: 1; coord y: 1; coord z: 1; \
    kinetic += (2 + x^2)*dt(x)^2 + dt(y)^2*(3 + z^2) + dt(z)^2 + dt(x)*dt(z)/2; potential += 9.81*y + x*z; \
    dissipation += dt(y)^2; constraint rod: x^2 + y^2 = 1; constraint same: (x^2 + y^2 - 1)*(2 + z) = 0; }";

/// Rows that depend on others are allowed what the state leaves open of them, and energy the work of the multipliers
/// along it: what is wrong by a millionth is refused all the same.
#[test]
fn redundant_rows_hide_nothing() {
    assert!(proof(TWICE, |_| ()).is_ok());
    let entries: &[(Kind, usize)] =
        &[(Kind::CoriolisMatrix, 9), (Kind::ConstraintJacobian, 6), (Kind::ConstraintBias, 2), (Kind::Bias, 3)];
    for &(kind, count) in entries {
        for result in 0..count {
            let change = |derivation: &mut Derivation| program(derivation, kind).stretch(result);
            let is_zero = proof(TWICE, change).is_ok();
            let (zeros, at) = (with_mechanism(TWICE, |l| zeros_of(&crate::derived(l), kind)), result);
            assert_eq!(is_zero, zeros.contains(&at), "{kind:?} {result}");
        }
    }
    // The systems that are solved: six entries of M, six of A, three forces and two rates of rows.
    for kind in [Kind::ForwardDynamics, Kind::Multipliers] {
        let zeros = with_mechanism(TWICE, |l| zeros_of(&crate::derived(l), kind));
        for result in 0..17 {
            let found = proof(TWICE, |derivation| program(derivation, kind).stretch(result));
            assert_eq!(found.is_ok(), zeros.contains(&result), "{kind:?} {result}: {found:?}");
        }
    }
}

/// A four-bar linkage in space whose hinges are declared in full: where it is closed, rows depend on others, and of
/// those that say nothing of the motion in its plane velocities that hold them leave rounding alone.
const LOOP: &str = include_str!("closed_loop.mbs");

/// What is allowed because a loop is closed to rounding alone (1e-13 of the terms of a row, what velocities leave of
/// it, the work of multipliers along what is left of the rates) is far from a millionth of what is computed.
#[test]
fn what_closed_loops_leave_open_hides_nothing() {
    assert!(proof(LOOP, |_| ()).is_ok());
    // Of the systems that are solved, after M and A: the forces in the plane, and what rows ask for there.
    let (n, k, first) = (8, 10, 36 + 80);
    let in_plane = [0, 1, 2, 3, 5].into_iter().chain([0, 1, 5, 6].map(|row| n + row)).map(|i| first + i);
    for (kind, results) in [
        (Kind::ForwardDynamics, in_plane.clone().collect()),
        (Kind::Multipliers, in_plane.collect()),
        (Kind::ConstraintBias, (0..k).collect::<Vec<_>>()),
    ] {
        let zeros = with_mechanism(LOOP, |l| zeros_of(&crate::derived(l), kind));
        for result in results.into_iter().filter(|result| !zeros.contains(result)) {
            let found = proof(LOOP, |derivation| program(derivation, kind).stretch(result));
            assert!(matches!(found, Err(Failure::Disagreement { .. })), "{kind:?} {result}: {found:?}");
        }
    }
    // Energy and a millionth of an angle, which changes along the motion. Twice the energy is conserved as well.
    refused(LOOP, "conserved quantities", |derivation| {
        let program = program(derivation, Kind::Conserved);
        let small = program.push(Instruction::Constant(Number::from_f64(2.0_f64.powi(-20)).expect("it is finite")));
        let angle = program.push(Instruction::Symbol(Symbol::Coordinate(0)));
        let product = program.push(Instruction::Mul(small, angle));
        program.results[0] = program.push(Instruction::Add(program.results[0], product));
    });
}

/// Which results are the constant zero.
fn zeros_of(derivation: &Derivation, kind: Kind) -> Vec<usize> {
    let program = &derivation.function(kind).expect("it is generated").program;
    let is_zero = |value: &Value| match program.instructions[value.index()] {
        Instruction::Constant(number) => number.to_f64() == 0.0,
        _ => false,
    };
    program.results.iter().enumerate().filter(|(_, value)| is_zero(value)).map(|(i, _)| i).collect()
}

/// A body of 1e-9 kg m² and its twin of 1e9: what has inertia has it in all units.
#[test]
fn accelerations_that_are_nan_are_refused_in_all_units() {
    for exponent in [-30, 0, 30] {
        let (m, l) = (2.0_f64.powi(2 * exponent), 2.0_f64.powi(exponent / 2));
        let text = format!(
            "#![dimensionless] mechanism A {{ coord x: 1; coord y: 1; coord z: 1; kinetic += {m:e}*(dt(x)^2 + dt(z)^2*(2 + \
             sin(x))); potential += {m:e}*x*z; constraint tie: {l:e}*y = {l:e}*(x + z^2); }}"
        );
        refused(&text, "accelerations are numbers", |derivation| {
            program(derivation, Kind::ForwardDynamics).become_undefined()
        });
    }
    refused(TWICE, "accelerations are numbers", |derivation| {
        program(derivation, Kind::ForwardDynamics).become_undefined()
    });
}

/// `[q̇]×` added to C: `C q̇` and the symmetric part of C are as before.
#[test]
fn the_coriolis_matrix_is_that_of_christoffel() {
    let text = "#![dimensionless] mechanism A { coord q[3]: 1; \
        kinetic += (2 + cos(q[1]))*dt(q[0])^2 + (3 + sin(q[2]))*dt(q[1])^2 + dt(q[2])^2 + dt(q[0])*dt(q[2])*q[1]/9; }";
    assert!(proof(text, |_| ()).is_ok());
    refused(text, "C = ½(Ṁ + ∂M/∂t + P − Pᵀ)", |derivation| {
        let program = program(derivation, Kind::CoriolisMatrix);
        let [x, y, z] = [0, 1, 2].map(|i| program.push(Instruction::Symbol(Symbol::Velocity(i))));
        for (at, value, is_negative) in
            [(1, z, true), (2, y, false), (3, z, false), (5, x, true), (6, y, true), (7, x, false)]
        {
            let entry = program.results[at];
            let sum = if is_negative { Instruction::Sub(entry, value) } else { Instruction::Add(entry, value) };
            program.results[at] = program.push(sum);
        }
    });
}

/// Derived from another declaration, that is as good where x is small; its energies are those declared.
fn refused_beyond(declared: &str, other: &str) {
    let text = |potential: &str| {
        format!(
            "#![dimensionless] mechanism A {{ param m: 1 = 2; coord x: 1; coord y: 1; kinetic += m*(dt(x)^2 + dt(y)^2); {potential} }}"
        )
    };
    let wrong = with_mechanism(&text(other), crate::derived);
    let found = proof(&text(declared), |derivation| {
        for function in derivation.altered().functions.iter_mut().filter(|function| !function.name.ends_with("_energy"))
        {
            let same = wrong.functions.iter().find(|other| other.name == function.name);
            *function = same.expect("both have it").clone();
        }
        derivation.altered().constructor = wrong.constructor.clone();
    });
    assert!(matches!(found, Err(Failure::Disagreement { .. })), "{declared}: {found:?}");
    assert_eq!(proof(&text(declared), |_| ()).map(|proof| proof.unproved), Ok(Vec::new()), "{declared}");
}

#[test]
fn every_side_of_a_branch_is_proved() {
    refused_beyond(
        "potential += if x > 50 { tan(x/100) } else { x };",
        "potential += if x > 50 { tan(x/99) } else { x };",
    );
    refused_beyond(
        "potential += if x*y < 1e4 && t < 100 { x^2 } else if y - x > 3e5 { x } else { y };",
        "potential += if x*y < 1e4 && t < 100 { x^2 } else if y - x > 3e5 { 2*x } else { y };",
    );
    refused_beyond(
        "potential += if x > 9 { if y < -9 { if x + y > 12 { x^3 } else { y } } else { x } } else { 0 };",
        "potential += if x > 9 { if y < -9 { if x + y > 12 { x^2 } else { y } } else { x } } else { 0 };",
    );
    refused_beyond("force x += max(dt(x)^2, 1e6) - y;", "force x += 1e6 - y;");
    refused_beyond("potential += abs(x - 40);", "potential += 40 - x;");
    refused_beyond("potential += if m > 9 { x^2 } else { x };", "potential += if m > 9 { x^3 } else { x };");
}

#[test]
fn sides_that_nothing_takes_are_named() {
    let text = "#![dimensionless] mechanism A { coord x: 1; kinetic += dt(x)^2; \
        potential += if x^2 < -1 { x } else { x^2 }; force x += min(2 + sin(x), 4); }";
    let (mut warnings, message) = (crate::diagnostic::Diagnostics::default(), |m: &crate::diagnostic::Diagnostic| {
        format!("{}: {}", &text[m.span.clone()], m.message)
    });
    with_mechanism(text, |lagrangian| {
        let proof = Proof::of(lagrangian, &crate::derived(lagrangian)).expect("it is right");
        proof.warn(lagrangian, &mut warnings);
    });
    let nowhere = "no state was found at which";
    assert_eq!(
        warnings.iter().map(message).collect::<Vec<_>>(),
        [
            format!("x^2 < -1: {nowhere} this condition holds: the equations there are not proved"),
            format!(
                "min(2 + sin(x), 4): {nowhere} the first of these is not the smaller one: the equations there are not proved"
            ),
        ]
    );
}

/// A speed's size that is not above zero is zero, where `abs` has its corner; a square has none there.
#[test]
fn sides_that_are_met_at_corners_alone_are_named_so() {
    let sides = |condition: &str| {
        let text = format!(
            "#![dimensionless] mechanism A {{ coord x: 1; kinetic += dt(x)^2; force x += if {condition} {{ -x }} else {{ 0 }}; }}"
        );
        let proof = proof(&text, |_| ()).expect("it is right");
        [proof.unproved, proof.at_corners].map(|sides| sides.iter().map(|side| side.1).collect::<Vec<_>>())
    };
    assert_eq!(sides("abs(dt(x)) > 0"), [vec![], vec![false]]);
    assert_eq!(sides("dt(x)^2 > 0"), [vec![], vec![]]);
    assert_eq!(sides("x^2 > 0"), [vec![], vec![]]);
    assert_eq!(sides("abs(x) > -1"), [vec![false], vec![]]);
}

/// The tool turns by `b − sin b + 1`, so that M is singular at b = 0; the pivot there is rounding and not zero. Where M
/// is not, wrong accelerations are refused.
#[test]
fn nothing_is_claimed_of_accelerations_where_a_motion_has_no_inertia() {
    let text = "mechanism Turning { param l: m = 0.38; param j: kg*m^2 = 1.6; param m[3]: kg = [1.5, 2, 2]; param f: J = 1; \
        param d: kg*m^2*s^-1 = 1; coord a: rad; coord b: rad; let arm = rot_y(a) * translation([l, 0, 0]); \
        let tool = arm * rot_x(0.39) * rot_z(b + (1 - sin(b))); \
        kinetic += rigid_body(m[0], [0, 0, 0], inertia(j, 1.1*j, j, 0, 0, 0), arm) + particle(m[1], arm.origin()); \
        kinetic += rigid_body(m[2], [0, 0, 0], diag(j, j, j), tool); \
        force b += -f; torque on arm += d*angular_velocity(tool); }";
    let found = proof(text, |_| ());
    assert!(matches!(found, Ok(Proof { states: 25, singular: 3, .. })), "{found:?}");
    refused(text, "M q̈ + h + ∂D/∂q̇ = Q + Aᵀ λ", |derivation| {
        let program = program(derivation, Kind::ForwardDynamics);
        let first = program.results[0];
        program.results[0] = program.push(Instruction::Neg(first));
    });
}

/// At its edge itself `<` and `<=` differ.
#[test]
fn edges_of_branches_are_met() {
    for condition in ["x < 3", "x >= -0.5", "abs(dt(x)) < 2", "-y <= x", "t > 7", "-abs(y) > -5"] {
        let text = format!(
            "#![dimensionless] mechanism A {{ coord x: 1; coord y: 1; kinetic += dt(x)^2 + dt(y)^2; \
             force x += if {condition} {{ 2 }} else {{ 5 }}; }}"
        );
        let swap = |derivation: &mut Derivation| {
            let instructions = &mut program(derivation, Kind::GeneralizedForce).instructions;
            for instruction in instructions {
                *instruction = match *instruction {
                    Instruction::Less(a, b) => Instruction::LessEqual(a, b),
                    Instruction::LessEqual(a, b) => Instruction::Less(a, b),
                    other => other,
                };
            }
        };
        assert!(proof(&text, |_| ()).is_ok(), "{condition}");
        let found = proof(&text, swap);
        assert!(matches!(found, Err(Failure::Disagreement { .. })), "{condition}: {found:?}");
    }
}

/// A stop, dry friction, a root on one side alone, and what holds on each side by its own law.
const STOPS: &str = "#![dimensionless] mechanism A { param k: 1 = 700; param gap: 1 = 0.3; coord x: 1; coord y: 1; \
    kinetic += dt(x)^2 + dt(y)^2*(1 + abs(x)^2); dissipation += if dt(x) > 0 { dt(x)^2 } else { dt(x)^2/2 }; \
    potential += if x > gap { k*(x - gap)^2/2 } else { if x < -gap { k*(x + gap)^2/3 } else { 0 } }; \
    potential += if y > 1 { sqrt(y^2 + 1) } else { abs(y)*signum(x)^2 }; }";

#[test]
fn each_side_of_every_choice_is_proved_in_fields() {
    let evidence = proof(STOPS, |_| {}).expect("it is right").evidence;
    assert!(evidence.in_doubles.is_empty() && evidence.digits > 20, "{evidence:?}");
    // Too little for doubles.
    let nearly_half = |derivation: &mut Derivation| {
        let derivation = derivation.altered();
        let programs = derivation.functions.iter_mut().map(|function| &mut function.program);
        let constants = programs.chain([&mut derivation.constructor]).flat_map(|program| &mut program.instructions);
        for constant in constants {
            if let Instruction::Constant(number) = constant
                && let value @ 0.5..0.7 = number.to_f64()
            {
                *number = Number::from_f64(value * (1.0 + 2f64.powi(-50))).expect("it is finite");
            }
        }
    };
    let found = proof(STOPS, nearly_half);
    assert!(matches!(found, Err(Failure::Inexact { .. })), "{found:?}");
}

#[test]
fn programs_that_use_what_is_not_made_are_refused() {
    let malformed = |change: fn(&mut Program)| {
        let found = proof(PENDULUM, |derivation| change(program(derivation, Kind::MassMatrix)));
        assert!(matches!(&found, Err(Failure::Malformed { function }) if function == "mass_matrix"), "{found:?}");
    };
    malformed(|program| program.results[0] = Value(1000));
    malformed(|program| program.instructions[0] = Instruction::Neg(Value(0)));
    malformed(|program| program.instructions[0] = Instruction::Hoisted(1000));
    malformed(|program| program.instructions[0] = Instruction::Symbol(Symbol::Multiplier(0)));
}
