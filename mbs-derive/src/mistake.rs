//! Rules of the generator that tests make wrong, to see that the proof refuses what comes of it.
//!
//! `rule!("name", right, wrong)` is `right`. In this crate's own tests it is `wrong` while the mistake of that name is
//! made; elsewhere `wrong` is not even compiled.

/// The right side of a rule, or the wrong one where a test asks for it.
macro_rules! rule {
    ($name:literal, $right:expr, $wrong:expr $(,)?) => {{
        #[cfg(not(test))]
        let value = $right;
        #[cfg(test)]
        let value = if crate::mistake::is_made($name) { $wrong } else { $right };
        value
    }};
}
pub(crate) use rule;

#[cfg(test)]
pub(crate) use tests::is_made;

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use crate::expr::Graph;
    use crate::source::Sources;
    use crate::{Analysis, Error, verify};

    thread_local! {
        static MADE: Cell<Option<&'static str>> = const { Cell::new(None) };
    }

    /// Whether the mistake of this name is made in this thread.
    pub(crate) fn is_made(name: &str) -> bool {
        MADE.get() == Some(name)
    }

    /// Texts in which rules are.
    const RULES: [&str; 20] = [
        include_str!("expr/function.rs"),
        include_str!("expr/tangent.rs"),
        include_str!("expr/adjoint.rs"),
        include_str!("expr/hessian.rs"),
        include_str!("expr/arithmetic.rs"),
        include_str!("expr/power.rs"),
        include_str!("expr/normal/half_angle.rs"),
        include_str!("derive.rs"),
        include_str!("derive/lagrange.rs"),
        include_str!("derive/constraint.rs"),
        include_str!("derive/reaction.rs"),
        include_str!("derive/conserved.rs"),
        include_str!("derive/linearize.rs"),
        include_str!("derive/solve.rs"),
        include_str!("derive/tree/newton_euler.rs"),
        include_str!("derive/tree/inertia.rs"),
        include_str!("derive/tree/coriolis.rs"),
        include_str!("derive/tree/composite.rs"),
        include_str!("derive/tree/articulated.rs"),
        include_str!("derive/tree/derivative.rs"),
    ];

    /// Mechanisms in which the rules are needed.
    fn mechanisms() -> Vec<Sources> {
        let inline = [
            // With nine joints, accelerations are derived by articulated bodies.
            "mechanism Rope {
                param m: 1 = 2; coord q[9]: 1;
                let mut link = world;
                for i in 0..9 {
                    link = link*rotation([2/3, 1/3, 2/3], q[i])*translation([1, 0, 1/4]);
                    kinetic += rigid_body(m, [1/3, 1/7, 0], inertia(1, 2, 2), link); potential += m*link.origin().z;
                }
            }",
            "mechanism Functions {
                param a: 1 = 1.3; param m: 1 = 2; coord x: 1; coord y: 1;
                kinetic += m*(1 + tan(x/3)^2)*dt(x)^2/2 + (2 + sin(y) + cosh(x)^3)*dt(y)^2/2 + tanh(y)*dt(x)*dt(y)/5
                    + dt(x)*(dt(x) + y*dt(y))/9;
                potential += a*tanh(x) + a*cos(x) + atan2(y, 2 + x^2) + (x^2 + y^2 + 1)^(3/2) - sin(x + 180 deg)/7;
            }",
            "mechanism Wheel {
                param m: 1 = 2; param w: 1 = 3; coord x: 1; coord y: 1;
                kinetic += m*(dt(x)^2 + (1 + x^2)*dt(y)^2)/2; lagrangian += w*t*dt(x) + w*x^3*dt(y)*t; potential += x^2*t;
            }",
            "mechanism Doubled {
                param a: 1 = 1.3; coord x: 1; coord y: 1;
                kinetic += (dt(x)^2 + 2*dt(x)*dt(y)*cos(x - y) + (3 + a*sin(2*x) + a*cos(2*x))*dt(y)^2)/2;
                potential += a*(sin(x)^2 + cos(x)^2)*y - (a*y - (a*y - x)*a)*x;
            }",
        ];
        let files = [
            "models/mechanisms/double_pendulum",
            "models/mechanisms/arm6",
            "tests/mechanisms/arm_with_reactions",
            "tests/mechanisms/rolling_coin",
            "tests/mechanisms/four_bar_with_reactions",
            "tests/mechanisms/tree_robot",
            "tests/mechanisms/driven_dampers",
        ];
        let dimensionless = |text: &&str| Sources::new("rule.mbs", &format!("#![dimensionless]\n{text}"));
        let read = |name: &&str| crate::read(std::path::Path::new(&format!("../{name}.mbs"))).unwrap();
        inline.iter().map(dimensionless).chain(files.iter().map(read)).collect()
    }

    /// What is derived, and whether it is proved.
    fn outcome(sources: &Sources) -> (String, Result<(), Error>) {
        let graph = Graph::verbatim();
        let analysis = Analysis::of(sources, &graph).unwrap_or_else(|error| panic!("{}", error.render_in(sources)));
        (format!("{:?}", analysis.programs()), analysis.prove(analysis.programs()).map(drop))
    }

    #[test]
    fn every_wrong_rule_is_refused() {
        // A package has no mechanisms beside it.
        if !std::path::Path::new("../models").exists() {
            return;
        }
        let names: Vec<&'static str> = RULES.iter().flat_map(|text| text.split("rule!(\"").skip(1)).collect();
        let names: Vec<&'static str> = names.into_iter().map(|rest| rest.split('"').next().unwrap_or("")).collect();
        assert!(names.len() >= 20, "{names:?}");
        let mechanisms = mechanisms();
        let right: Vec<String> = mechanisms.iter().map(|sources| outcome(sources).0).collect();
        let mut passed = Vec::new();
        for name in names {
            MADE.set(Some(name));
            let wrong = mechanisms.iter().zip(&right).find_map(|(sources, right)| {
                let (programs, proof) = outcome(sources);
                (programs != *right).then_some(proof)
            });
            MADE.set(None);
            match wrong {
                Some(Err(Error::Proof(
                    verify::Failure::Disagreement { .. }
                    | verify::Failure::Inexact { .. }
                    | verify::Failure::NegativeInertia { .. },
                ))) => {}
                other => passed.push((name, other)),
            }
        }
        // `None` where no mechanism needs the rule.
        assert!(passed.is_empty(), "{passed:?}");
    }
}
