//! What acts along joints: inputs, dampers, rotors of drives, springs, dry friction.

use std::fmt::Write as _;

use super::super::pose::shown;
use super::super::robot::{Joint, Kind};
use super::super::xml::Reader;
use super::{Writer, line};

impl Writer<'_> {
    /// What acts along a joint.
    pub(super) fn effects(&mut self, name: &str, joint: &Joint, reader: &mut Reader) {
        let follows = joint.mimic.is_some();
        match joint.kind {
            Kind::Hinge if !follows => {
                line!(self, "    force {name} += {name}_torque;");
            }
            Kind::Slide if !follows => {
                line!(self, "    force {name} += {name}_force;");
            }
            Kind::Ball => {
                // On the turn of the body against what it hangs on, which is pushed back by as much.
                let turn = self.attitude(name);
                let turn = turn.trim_start_matches(" * ");
                line!(self, "    torque on {turn} += {turn} * {name}_torque; // between the two bodies");
            }
            Kind::Hinge | Kind::Slide | Kind::Planar | Kind::Free => {}
        }
        if matches!(joint.kind, Kind::Ball | Kind::Free) && !self.options.angles {
            let squares: Vec<String> = (0..4).map(|i| format!("{name}_attitude[{i}]^2")).collect();
            line!(self, "    constraint {name}_unit: {} = 1;", squares.join(" + "));
        }
        // Squares of the joint's rates, each with the unit of what multiplies it.
        let rates: Vec<(String, &str)> = match joint.kind {
            Kind::Hinge => vec![(format!("dt({name})^2"), "rad")],
            Kind::Slide => vec![(format!("dt({name})^2"), "m")],
            Kind::Planar => {
                vec![(format!("(dt({name}_x)^2 + dt({name}_y)^2)"), "m"), (format!("dt({name}_angle)^2"), "rad")]
            }
            Kind::Ball | Kind::Free => {
                let squares = |what: &str, n: usize| {
                    let all: Vec<String> = (0..n).map(|i| format!("dt({name}_{what}[{i}])^2")).collect();
                    format!("({})", all.join(" + "))
                };
                let place = (joint.kind == Kind::Free).then(|| (squares("place", 3), "m"));
                // Of a unit quaternion ω² is four times the square of its rate.
                place.into_iter().chain([(format!("4*{}", squares("attitude", 4)), "rad")]).collect()
            }
        };
        let several = rates.len() > 1;
        let acts = [joint.damping, joint.armature, joint.stiffness].iter().any(|&number| number != 0.0);
        if acts && matches!(joint.kind, Kind::Ball | Kind::Free) && self.options.angles {
            let message = format!("the damping or armature of the joint `{}` is not that of its angles", joint.name);
            reader.refuse(joint.span.clone(), message, "import it with a quaternion");
            return;
        }
        if joint.stiffness != 0.0 && matches!(joint.kind, Kind::Ball | Kind::Free | Kind::Planar) {
            let message = format!(
                "the spring of the joint `{}` is not imported: the joint turns about more than an axis",
                joint.name
            );
            reader.refuse(joint.span.clone(), message, "leave it out, and write it as an energy beside the import");
            return;
        }
        let index = |i: usize| if several { format!("_{i}") } else { String::new() };
        for (i, (rate, unit)) in rates.iter().enumerate().filter(|_| joint.damping != 0.0) {
            let unit = if *unit == "m" { "N*s/m" } else { "N*m*s" };
            line!(self, "    const {name}_damping{}: {unit} = {};", index(i), shown(joint.damping));
            line!(self, "    dissipation += 1/2*{name}_damping{}*{rate};", index(i));
        }
        for (i, (rate, unit)) in rates.iter().enumerate().filter(|_| joint.armature != 0.0) {
            let unit = if *unit == "m" { "kg" } else { "kg*m^2" };
            line!(
                self,
                "    const {name}_armature{}: {unit} = {}; // of the drive's rotor",
                index(i),
                shown(joint.armature)
            );
            line!(self, "    kinetic += 1/2*{name}_armature{}*{rate};", index(i));
        }
        if joint.stiffness != 0.0 {
            let (unit, way) = if joint.kind == Kind::Slide { ("N/m", "m") } else { ("N*m", "rad") };
            line!(self, "    const {name}_stiffness: {unit} = {};", shown(joint.stiffness));
            line!(self, "    const {name}_rest: {way} = {};", shown(joint.rest));
            line!(self, "    potential += 1/2*{name}_stiffness*({name} - {name}_rest)^2;");
        }
        if joint.friction != 0.0 {
            self.friction(name, joint, &rates);
        }
    }

    /// Dry friction as statements in comments, which can be taken out of them.
    fn friction(&mut self, name: &str, joint: &Joint, rates: &[(String, &str)]) {
        let unit = match joint.kind {
            Kind::Slide => "N",
            Kind::Hinge | Kind::Ball => "N*m",
            Kind::Planar | Kind::Free => "N and N*m",
        };
        let amount =
            format!("    // Dry friction of {} {unit} is left out: it has a jump at rest.", shown(joint.friction));
        if matches!(joint.kind, Kind::Ball | Kind::Free) && self.options.angles {
            line!(self, "{amount}");
            return;
        }
        line!(self, "{amount} Rounded off below a slow rate it would be");
        for (i, (rate, way)) in rates.iter().enumerate() {
            let index = if rates.len() > 1 { format!("_{i}") } else { String::new() };
            let unit = if *way == "m" { "N" } else { "N*m" };
            line!(self, "    // const {name}_friction{index}: {unit} = {};", shown(joint.friction));
            line!(self, "    // const {name}_slow{index}: {way}/s = 1e-3;");
            line!(self, "    // dissipation += {name}_friction{index}*sqrt({rate} + {name}_slow{index}^2);");
        }
    }
}
