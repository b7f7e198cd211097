//! Frames that move, places in them, and bodies.

use super::{Construct, Draw, Measure};

impl Draw {
    /// Three lengths, most of them 0.
    pub(super) fn vector(&mut self, depth: usize) -> String {
        let mut entry = || if self.chance(50) { "0".to_string() } else { self.length(depth) };
        let (x, y) = (entry(), entry());
        let z = if x == "0" && y == "0" { self.length(depth) } else { entry() };
        format!("[{x}, {y}, {z}]")
    }

    /// Three parameters, most of them 0.
    pub(super) fn fixed_vector(&mut self, dimension: [i32; 3]) -> String {
        let mut entry = || if self.chance(50) { "0".to_string() } else { self.parameter(dimension) };
        let (x, y) = (entry(), entry());
        let z = if x == "0" && y == "0" { self.parameter(dimension) } else { entry() };
        format!("[{x}, {y}, {z}]")
    }

    /// A turn or shift by a coordinate.
    fn joint(&mut self, along: bool) -> String {
        if self.has(Construct::Arrays) && !along && self.chance(50) {
            return self.turn_of_arrays();
        }
        // Of other coordinates: with its own the angle might stay where it is.
        let offset = self.plain(1);
        let coordinate = self.coordinate(if along { Measure::Length } else { Measure::Angle });
        let sign = if self.chance(20) { "-" } else { "" };
        if along {
            return match self.below(4) {
                0 => format!("translation([{coordinate}, 0, 0])"),
                1 => format!("translation(0, {sign}{coordinate}, {})", self.length(0)),
                2 => format!("dh({}, {coordinate}, 0, pi/2)", self.number()),
                _ => format!("translation([0, {}*{coordinate}, {coordinate}])", self.number()),
            };
        }
        match self.below(9) {
            0 | 1 => format!("rot_x({sign}{coordinate})"),
            2 | 3 => format!("rot_y({sign}{coordinate})"),
            4 | 5 => format!("rot_z({coordinate})"),
            6 => format!("rotation([1, -2, 0.5], {coordinate})"),
            7 => format!(
                "dh({coordinate}, {}, {}, {})",
                self.parameter([0, 1, 0]),
                self.parameter([0, 1, 0]),
                self.number()
            ),
            _ => format!("rot_z({coordinate} + {offset})"),
        }
    }

    /// A rigid connection, or one that a signal moves.
    fn connection(&mut self) -> String {
        match self.below(7) {
            0 => format!("rot_x({})", self.number()),
            1 => format!("rotation([0, 3, 4], {})", self.number()),
            2 if !self.angles.is_empty() => {
                let angles = self.angles.clone();
                format!("rot_y({})", self.pick(&angles))
            }
            3 if !self.lengths.is_empty() => {
                let lengths = self.lengths.clone();
                format!("translation([0, {}, 0])", self.pick(&lengths))
            }
            4 => format!("translation({}).inverse()", self.fixed_vector([0, 1, 0])),
            _ => format!("translation({})", self.fixed_vector([0, 1, 0])),
        }
    }

    /// Bodies on a tree of joints.
    pub(super) fn tree(&mut self) {
        let count = 1 + self.below(if self.has(Construct::Quaternions) { 2 } else { 3 });
        for _ in 0..count {
            let base = if self.poses.is_empty() || self.chance(25) {
                "world".to_string()
            } else {
                let poses = self.poses.clone();
                self.pick(&poses)
            };
            let along = self.chance(30);
            let turns = !along || self.turning.contains(&base);
            let mut factors = vec![base];
            if self.chance(40) {
                factors.push(self.connection());
            }
            factors.push(self.joint(along));
            if self.chance(50) {
                factors.push(self.connection());
            }
            let name = self.fresh("link");
            let written = factors.join(" * ");
            self.statements.push(format!("let mut {name} = {written};"));
            if self.has(Construct::Reactions) && self.chance(70) {
                let reaction = self.fresh("joint");
                self.statements.push(format!("reaction {reaction} at {name};"));
            }
            self.body(&name);
            if turns {
                self.turning.push(name.clone());
            }
            self.poses.push(name);
        }
    }

    /// A tensor that a body can have.
    pub(super) fn inertia(&mut self) -> String {
        if self.has(Construct::Arrays) && self.chance(60) {
            return self.inertia_of_arrays();
        }
        let moment = self.parameter([1, 2, 0]);
        match self.below(4) {
            0 => format!("diag({moment}, {moment}, {moment})"),
            1 => format!("diag({moment}, 1.2*{moment}, 0.7*{moment})"),
            2 => format!("inertia({moment}, 1.1*{moment}, 0.9*{moment}, 0.1*{moment}, -0.05*{moment}, {moment}/20)"),
            _ => format!("diag(1, 1.5, 2)*{moment}"),
        }
    }

    /// A body with inertia about all axes, so that whatever moves its frame has inertia.
    pub(super) fn body(&mut self, pose: &str) {
        let (mass, inertia) = (self.parameter([1, 0, 0]), self.inertia());
        let centre = if self.chance(30) { "[0, 0, 0]".to_string() } else { self.fixed_vector([0, 1, 0]) };
        if self.chance(25) {
            let (place, turning) = (self.fresh("c"), self.fresh("turning"));
            self.say(format!("let {place} = {pose}.point({centre});"));
            self.say(format!("let {turning} = angular_velocity({pose});"));
            self.say(format!(
                "kinetic += 1/2*{mass}*dt({place}).norm_squared() + 1/2*{turning}.dot(({pose}*{inertia})*{turning});"
            ));
        } else {
            self.say(format!("kinetic += rigid_body({mass}, {centre}, {inertia}, {pose});"));
        }
        let place = self.fresh("place");
        let (vector, other) = (self.fixed_vector([0, 1, 0]), self.fixed_vector([0, 1, 0]));
        let point = match self.below(7) {
            0 | 1 => format!("{pose}.origin()"),
            2 => format!("{pose}.origin() + {pose}*{vector}"),
            3 => format!("{pose}.point({other}) - {vector}"),
            4 => format!("(rot_y(0.3)*translation({other})) * {pose}.point({vector})"),
            _ => format!("{pose}.point({vector})"),
        };
        self.say(format!("let {place} = {point};"));
        if !self.has(Construct::Gravity) && self.chance(60) {
            let acceleration = self.parameter([0, 1, -2]);
            self.say(format!("potential += {mass}*{acceleration}*{place}.z;"));
        }
        if self.chance(30) {
            // Of another mass than a body that was written out: gravity knows energies by their expressions.
            let mass = self.parameter([1, 0, 0]);
            self.say(format!("kinetic += particle(1.5*{mass}, {place});"));
        }
        self.places.push(place);
    }

    /// A free body.
    pub(super) fn quaternion_body(&mut self) {
        let (e, r, pose) = (self.fresh("e"), self.fresh("r"), self.fresh("body"));
        self.declarations.push(format!("coord {e}[4]: 1;"));
        let shift = if self.chance(50) {
            self.declarations.push(format!("coord {r}[3]: m;"));
            for i in 0..3 {
                self.coordinates.push(super::Coordinate { name: format!("{r}[{i}]"), measure: Measure::Length });
            }
            format!("translation({r})")
        } else {
            format!("translation({})", self.fixed_vector([0, 1, 0]))
        };
        let offset = if self.chance(30) { format!(" * {}", self.connection()) } else { String::new() };
        let attitude = if self.has(Construct::Arrays) && self.chance(60) {
            format!("quaternion({e})")
        } else {
            format!("quaternion({e}[0], {e}[1], {e}[2], {e}[3])")
        };
        self.say(format!("let mut {pose} = {shift} * {attitude}{offset};"));
        if self.chance(40) {
            // Anything from a grain of dust to a mountain.
            let (mass, moment) = (self.fresh("m"), self.fresh("i"));
            let exponent = self.below(31) as i32 - 18;
            let heavier = 4 - self.below(6) as i32;
            let (m, i) = (self.scaled(exponent + heavier), self.scaled(exponent));
            self.declarations.push(format!("param {mass}: kg = {m};"));
            self.declarations.push(format!("param {moment}: kg*m^2 = {i};"));
            self.say(format!(
                "kinetic += rigid_body({mass}, [0, 0, 0], diag({moment}, 1.5*{moment}, 2*{moment}), {pose});"
            ));
        } else {
            self.body(&pose);
        }
        self.turning.push(pose.clone());
        self.poses.push(pose);
        self.say(format!("constraint unit: {e}[0]^2 + {e}[1]^2 + {e}[2]^2 + {e}[3]^2 = 1;"));
    }

    /// A chain in a loop.
    pub(super) fn loops(&mut self) {
        let (n, q, m, l) = (self.fresh("n"), self.fresh("q"), self.fresh("m"), self.fresh("l"));
        let count = 2 + self.below(2);
        let (link, moment) = (self.fresh("chain"), self.parameter([1, 2, 0]));
        let [mass, length, _] = self.scale;
        let masses: Vec<String> = (0..count).map(|_| self.scaled(mass)).collect();
        let one = self.scaled(length);
        self.declarations.push(format!("const {n} = {count};"));
        self.declarations.push(format!("coord {q}[{n}]: rad;"));
        self.declarations.push(format!("param {m}[{n}]: kg = [{}];", masses.join(", ")));
        self.declarations.push(format!("param {l}[{n}]: m = {one};"));
        let turn = self.pick(&["rot_x", "rot_y", "rot_z"]);
        let acceleration = self.parameter([0, 1, -2]);
        let relative = self.chance(50);
        let angle =
            if relative { format!("{q}[i]") } else { format!("{q}[i] - (if i > 0 {{ {q}[i - 1] }} else {{ 0 }})") };
        self.say(format!("let mut {link} = world;"));
        let mut body = vec![format!("{link} = {link} * {turn}({angle});")];
        if self.has(Construct::Reactions) {
            let joint = self.fresh("hinge");
            body.push(format!("reaction {joint}[i] at {link};"));
        }
        body.push(format!("let centre = {link}.point([{l}[i]/2, 0, {l}[i]]);"));
        body.push(format!("kinetic += particle({m}[i], centre) + 1/2*{moment}*dt({q}[i])^2;"));
        if self.has(Construct::Outputs) && self.chance(50) {
            let (name, rate) = (self.fresh("y"), if self.chance(40) { ", jacobian_rate" } else { "" });
            let value = match self.below(4) {
                0 => link.clone(),
                1 => "centre".to_string(),
                2 => format!("{link}.rotation()"),
                _ => format!("[sin({q}[i]), {q}[0]]"),
            };
            body.push(format!("output {name}[i] = {value}{rate};"));
        }
        body.push(format!("potential += {m}[i]*{acceleration}*centre.z;"));
        if self.chance(40) {
            let (frames, heights) = (self.fresh("frames"), self.fresh("h"));
            self.say(format!("let {frames}[{n}];"));
            body.push(format!("{frames}[i] = {link};"));
            body.push(format!("output {heights}[i] = {frames}[i].point([0, {l}[i], 0]).z;"));
            self.poses.push(format!("{frames}[1]"));
        }
        if self.chance(40) {
            let (grid, energy) = (self.fresh("grid"), self.parameter([1, 2, -2]));
            self.say(format!("let {grid}[{n}][2];"));
            body.push(format!("{grid}[i][0] = {q}[i] - 1; {grid}[i][1] = sin({q}[i])*{q}[0];"));
            self.plains.push(format!("{grid}[{}][1]", count - 1));
            body.push(format!("potential += {energy}*{grid}[i][0]*{grid}[i][1];"));
        }
        if self.has(Construct::Constraints) && self.chance(60) {
            let (carried, tie) = (self.fresh("s"), self.fresh("ties"));
            self.declarations.push(format!("coord {carried}[{n}]: rad;"));
            let own =
                if self.chance(50) { format!("kinetic += 1/2*{moment}*dt({carried}[i])^2; ") } else { String::new() };
            let row = self.pick(&["# = sin(@)", "dt(#) = cos(@)*dt(@)", "0 = # - @/2"]);
            let row = row.replace('#', &format!("{carried}[i]")).replace('@', &format!("{q}[i]"));
            body.push(format!("{own}constraint {tie}[i]: {row};"));
            for i in 0..count {
                let name = format!("{carried}[{i}]");
                self.coordinates.push(super::Coordinate { name, measure: Measure::Angle });
            }
        }
        if self.chance(40) {
            let torque = self.parameter([1, 2, -2]);
            body.push(format!(
                "if i == 0 {{ force {q}[i] += {torque}; }} else if i > 1 {{ force {q}[i] += -{torque}*sin({q}[i - 1]); }}"
            ));
        }
        body.push(format!("{link} = {link} * translation([{l}[i], 0, 0]);"));
        if self.has(Construct::Forces) {
            let drives = self.fresh("u");
            self.declarations.push(format!("input {drives}[{n}]: N*m;"));
            self.say(format!("force {q} += {drives};"));
        }
        self.say(format!("for i in 0..{n} {{ {} }}", body.join(" ")));
        for i in 0..count {
            self.coordinates.push(super::Coordinate { name: format!("{q}[{i}]"), measure: Measure::Angle });
        }
        let place = self.fresh("place");
        self.say(format!("let {place} = {link}.origin();"));
        self.places.push(place);
        self.turning.push(link.clone());
        self.poses.push(link);
    }
}
