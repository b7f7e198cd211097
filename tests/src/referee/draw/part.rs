//! Parts and their instances.

use super::{Construct, Draw, Measure};

/// What a drawn part offers beside its pose.
struct Rod {
    name: String,
    /// Its output, if it has one.
    tip: Option<String>,
    /// The pose at its end.
    end: String,
    /// Whether it wants a coordinate that follows the other one.
    follows: bool,
}

impl Draw {
    /// A rod that is used once or more, alone, in a loop or in another part.
    pub(super) fn parts(&mut self) {
        let rod = self.rod();
        if self.chance(40) {
            self.limb(&rod);
        } else if self.chance(50) {
            self.rods_in_a_loop(&rod);
        } else {
            let (pose, instance) = (self.known_pose(), self.fresh("rod"));
            let use_ = self.instance(&rod, &instance, &pose);
            self.say(use_);
            self.found(&instance, &rod);
        }
    }

    fn known_pose(&mut self) -> String {
        if self.poses.is_empty() || self.chance(30) {
            return "world".to_string();
        }
        let poses = self.poses.clone();
        self.pick(&poses)
    }

    /// The part: with names of its own, on the coordinate that it is given.
    fn rod(&mut self) -> Rod {
        let (name, end) = (self.fresh_part("Rod"), self.fresh("end"));
        let turn = self.pick(&["rot_x", "rot_y", "rot_z"]);
        let mut body = vec![format!("let mut hinged = pose * {turn}(angle);")];
        if self.has(Construct::Reactions) {
            body.push("reaction hinge at hinged;".to_string());
        }
        body.push(format!("let {end} = hinged * translation([0, length/3, -length]);"));
        body.push("const share = 1/12;".to_string());
        body.push(
            "kinetic += rigid_body(mass, [0, 0, -length/2], diag(1, 1.1, 0.3)*share*mass*length^2, hinged);"
                .to_string(),
        );
        if !self.has(Construct::Gravity) && self.chance(50) {
            let acceleration = self.parameter([0, 1, -2]);
            body.push(format!("potential += mass*{acceleration}*hinged.point([0, 0, -length/2]).z;"));
        }
        if self.has(Construct::Forces) {
            let (torque, damping) = (self.parameter([1, 2, -2]), self.parameter([1, 2, -1]));
            body.push(format!("force angle += {torque}*cos(angle);"));
            body.push(format!("dissipation += 1/2*{damping}*dt(angle)^2;"));
        }
        if self.has(Construct::PointForces) {
            let force = self.parameter([1, 1, -2]);
            body.push(format!("force at {end}.origin() += hinged * [{force}, 0, 0];"));
        }
        let follows = self.has(Construct::Constraints) && self.chance(60);
        if follows {
            let row = self.pick(&["follower = angle/2", "dt(follower) = cos(angle)*dt(angle)"]);
            body.push(format!("constraint geared: {row};"));
        }
        let tip = self.chance(60).then(|| self.fresh("tip"));
        if let Some(tip) = &tip {
            body.push(format!("output {tip} = {end}.origin();"));
        }
        if self.chance(40) {
            body.push("for i in 0..2 { if i == 1 { output turned[i - 1] = hinged * [0, length, 0]; } }".to_string());
        }
        let follower = if follows { ", follower" } else { "" };
        self.functions.push(format!("part {name}(mass, length, pose, angle{follower}) {{ {} }}", body.join(" ")));
        Rod { name, tip, end, follows }
    }

    fn instance(&mut self, rod: &Rod, name: &str, pose: &str) -> String {
        let angle = self.coordinate(Measure::Angle);
        self.instance_on(rod, name, pose, &angle)
    }

    fn instance_on(&mut self, rod: &Rod, name: &str, pose: &str, angle: &str) -> String {
        let (mass, length) = (self.parameter([1, 0, 0]), self.parameter([0, 1, 0]));
        let follower = if rod.follows { format!(", {}", self.coordinate(Measure::Angle)) } else { String::new() };
        format!("{} {name}({mass}, {length}, {pose}, {angle}{follower});", rod.name)
    }

    /// What may be named behind an instance.
    fn found(&mut self, instance: &str, rod: &Rod) {
        let end = format!("{instance}.{}", rod.end);
        let place = self.fresh("place");
        let value = rod.tip.as_ref().map_or(format!("{end}.origin()"), |tip| format!("{instance}.{tip}"));
        self.say(format!("let {place} = {value};"));
        self.places.push(place);
        self.turning.push(end.clone());
        self.poses.push(end);
    }

    /// Rods with an index, one on the other or side by side.
    fn rods_in_a_loop(&mut self, rod: &Rod) {
        let (q, instance) = (self.fresh("q"), self.fresh("rods"));
        self.declarations.push(format!("coord {q}[2]: rad;"));
        for i in 0..2 {
            self.coordinates.push(super::Coordinate { name: format!("{q}[{i}]"), measure: Measure::Angle });
        }
        let (mass, length) = (self.parameter([1, 0, 0]), self.parameter([0, 1, 0]));
        let follower = rod.follows.then(|| {
            let name = self.fresh("s");
            self.declarations.push(format!("coord {name}[2]: rad;"));
            for i in 0..2 {
                self.coordinates.push(super::Coordinate { name: format!("{name}[{i}]"), measure: Measure::Angle });
            }
            format!(", {name}[i]")
        });
        let (base, at) = (self.known_pose(), self.fresh("at"));
        self.say(format!("let mut {at} = {base};"));
        let go_on = if self.chance(50) { format!("{at} = {instance}[i].{};", rod.end) } else { String::new() };
        self.say(format!(
            "for i in 0..2 {{ {} {instance}[i]({mass}, {length}, {at}, {q}[i]{}); {go_on} }}",
            rod.name,
            follower.unwrap_or_default()
        ));
        self.found(&format!("{instance}[1]"), rod);
    }

    /// A part of two rods.
    fn limb(&mut self, rod: &Rod) {
        let (name, instance) = (self.fresh_part("Limb"), self.fresh("limb"));
        let (upper, lower) = (self.fresh("upper"), self.fresh("lower"));
        let (first, second) = (
            self.instance_on(rod, &upper, "pose", "one"),
            self.instance_on(rod, &lower, &format!("{upper}.{}", rod.end), "other"),
        );
        let statement = format!("part {name}(pose, one, other) {{ {first} {second} }}");
        // Parts may be used before they are declared.
        if self.chance(50) {
            self.functions.push(statement);
            self.limb_instance(&name, &instance);
        } else {
            self.limb_instance(&name, &instance);
            self.say(statement);
        }
        self.found(&format!("{instance}.{lower}"), rod);
    }

    fn limb_instance(&mut self, part: &str, name: &str) {
        let (pose, a, b) = (self.known_pose(), self.coordinate(Measure::Angle), self.coordinate(Measure::Angle));
        self.say(format!("{part} {name}({pose}, {a}, {b});"));
    }
}
