//! Energies, forces and outputs.

use super::{Construct, Draw, Measure};

impl Draw {
    /// Inertia that belongs to one coordinate alone.
    pub(super) fn own_inertia(&mut self, coordinate: &str, measure: Measure) {
        let inertia = self.parameter(if measure == Measure::Length { [1, 0, 0] } else { [1, 2, 0] });
        self.say(format!("kinetic += 1/2*{inertia}*dt({coordinate})^2;"));
    }

    pub(super) fn energies(&mut self) {
        let count = 1 + self.below(2);
        for _ in 0..count {
            let term = self.potential();
            self.say(format!("potential += {term};"));
        }
        if !self.has(Construct::Energies) {
            return;
        }
        let count = 1 + self.below(3);
        for _ in 0..count {
            let term = self.kinetic();
            self.say(term);
        }
    }

    fn potential(&mut self) -> String {
        if !self.tabulated.is_empty() && self.chance(30) {
            let (functions, energy) = (self.tabulated.clone(), self.parameter([1, 2, -2]));
            return format!("{energy}*{}({})", self.pick(&functions), self.plain(1));
        }
        match self.below(6) {
            0 => format!("spring({}, {}, {})", self.parameter([1, 0, -2]), self.length(2), self.parameter([0, 1, 0])),
            1 => format!("1/2*{}*({})^2", self.parameter([1, 2, -2]), self.angle(1)),
            2 if self.places.len() > 1 => {
                let places = self.places.clone();
                let (one, other) = (self.pick(&places), self.pick(&places));
                let (stiffness, rest) = (self.parameter([1, 0, -2]), self.parameter([0, 1, 0]));
                format!("spring({stiffness}, sqrt(({one} - {other}).norm_squared() + {rest}^2), {rest})")
            }
            3 if !self.places.is_empty() => {
                let (places, scale) = (self.places.clone(), self.parameter([0, 1, 0]));
                let place = self.pick(&places);
                format!("-{}/sqrt(1 + {place}.norm_squared()/{scale}^2)", self.parameter([1, 2, -2]))
            }
            _ => format!("{}*{}", self.parameter([1, 2, -2]), self.plain(3)),
        }
    }

    fn kinetic(&mut self) -> String {
        match self.below(6) {
            0 => format!("kinetic += 1/2*{}*dt({})^2;", self.parameter([1, 0, 0]), self.length(2)),
            1 => format!(
                "kinetic += 1/2*{}*(1 + ({})^2)*dt({})^2;",
                self.parameter([1, 0, 0]),
                self.plain(1),
                self.length(1)
            ),
            2 => format!("kinetic += particle({}, {});", self.parameter([1, 0, 0]), self.vector(2)),
            3 => format!("lagrangian += {}*{}*dt({});", self.parameter([1, 1, -1]), self.plain(2), self.length(0)),
            4 => format!("lagrangian += {}*{};", self.parameter([1, 2, -2]), self.plain(2)),
            _ => format!("kinetic += 1/2*{}*dt({})^2;", self.parameter([1, 2, 0]), self.angle(1)),
        }
    }

    /// On coordinates, at places, on bodies; and dissipation.
    pub(super) fn forces(&mut self) {
        if self.has(Construct::Forces) || self.has(Construct::Tables) && self.chance(50) {
            let count = 1 + self.below(3);
            for _ in 0..count {
                let statement = self.coordinate_force();
                self.say(statement);
            }
            let statement = self.dissipation();
            self.say(statement);
        }
        if self.has(Construct::PointForces) && !self.places.is_empty() {
            let count = 1 + self.below(2);
            for _ in 0..count {
                let statement = self.point_force();
                self.say(statement);
            }
        }
    }

    /// A number that depends on a velocity.
    fn plain_rate(&mut self) -> String {
        let (length, speed) = (self.length(1), self.parameter([0, 1, -1]));
        format!("dt({length})/{speed}")
    }

    fn coordinate_force(&mut self) -> String {
        let coordinates = self.coordinates.clone();
        let coordinate = self.pick(&coordinates);
        let name = coordinate.name;
        let (dimension, unit) = match coordinate.measure {
            Measure::Length => ([1, 1, -2], "N"),
            Measure::Angle => ([1, 2, -2], "N*m"),
        };
        let strength = self.parameter(dimension);
        if !self.tabulated.is_empty() && self.chance(50) {
            let functions = self.tabulated.clone();
            let (function, argument) =
                (self.pick(&functions), if self.chance(50) { self.plain(1) } else { self.plain_rate() });
            return format!("force {name} += -{strength}*{function}({argument});");
        }
        let value = match self.below(6) {
            0 => self.input(unit),
            1 => format!("-{strength}*tanh({})", self.plain_rate()),
            2 => format!("{strength}*{}*{}", self.plain(1), self.plain(1)),
            3 if coordinate.measure == Measure::Length => {
                let (v, w) = (self.parameter([0, 1, -1]), self.parameter([0, 1, -1]));
                format!("coulomb_stribeck(dt({name}), {strength}, 1.5*{strength}, {v}, {w})")
            }
            4 if coordinate.measure == Measure::Length => {
                let (k, c, l) = (self.parameter([1, 0, -2]), self.parameter([1, 0, -1]), self.parameter([0, 1, 0]));
                format!("contact({name} - {l}, {k}, {c}, dt({name}))")
            }
            _ => format!("-{strength}*({})*{}", self.plain_rate(), self.plain(1)),
        };
        format!("force {name} += {value};")
    }

    fn dissipation(&mut self) -> String {
        let damping = self.parameter([1, 0, -1]);
        match self.below(4) {
            0 if !self.places.is_empty() => {
                let places = self.places.clone();
                format!("dissipation += 1/2*{damping}*dt({}).norm_squared();", self.pick(&places))
            }
            1 if !self.poses.is_empty() => {
                let (poses, damping) = (self.poses.clone(), self.parameter([1, 2, -1]));
                format!("dissipation += 1/2*{damping}*angular_velocity({}).norm_squared();", self.pick(&poses))
            }
            2 => format!("dissipation += {}*(sqrt(1 + ({})^2) - 1);", self.parameter([1, 2, -3]), self.plain_rate()),
            _ => format!("dissipation += 1/2*{damping}*(1 + ({})^2)*dt({})^2;", self.plain(1), self.length(1)),
        }
    }

    fn point_force(&mut self) -> String {
        let (poses, places) = (self.poses.clone(), self.places.clone());
        let (pose, place, turning) = (self.pick(&poses), self.pick(&places), self.turning.clone());
        let (force, moment) = (self.fixed_vector([1, 1, -2]), self.fixed_vector([1, 2, -2]));
        match self.below(7) {
            0 => format!("force at {place} += {force};"),
            1 => format!("force at {pose}.point({}) += {pose} * {force};", self.fixed_vector([0, 1, 0])),
            2 => format!("force at {place} += -{}*dt({place});", self.parameter([1, 0, -1])),
            3 if !turning.is_empty() => format!("torque on {} += {pose} * {moment};", self.pick(&turning)),
            4 if !turning.is_empty() => {
                format!(
                    "torque on {} += -{}*angular_velocity({pose});",
                    self.pick(&turning),
                    self.parameter([1, 2, -1])
                )
            }
            5 => {
                let (input, plain) = (self.input("N"), self.plain(1));
                format!("force at {place} += {pose} * [0, {input}, {plain}*{input}];")
            }
            _ if !turning.is_empty() => format!("torque on {} += {}*{moment};", self.pick(&turning), self.plain(2)),
            _ => format!("force at {place} += {}*{force};", self.plain(2)),
        }
    }

    pub(super) fn outputs(&mut self) {
        let count = 1 + self.below(3);
        for _ in 0..count {
            let name = self.fresh("y");
            let (poses, places) = (self.poses.clone(), self.places.clone());
            let rate = if self.chance(40) { ", jacobian_rate" } else { "" };
            let statement = match self.below(14) {
                0 if !places.is_empty() => format!("{}{rate}", self.pick(&places)),
                1 if !poses.is_empty() => format!("{}{rate}", self.pick(&poses)),
                2 if !poses.is_empty() => format!("{}.rotation(){rate}", self.pick(&poses)),
                3 if !poses.is_empty() => format!("angular_velocity({})", self.pick(&poses)),
                4 if !places.is_empty() => format!("dt({})", self.pick(&places)),
                8 if !poses.is_empty() => format!("{} * {}", self.pick(&poses), self.inertia()),
                9 if places.len() > 1 => {
                    format!("cross({}, {}){rate}", self.pick(&places), self.pick(&places))
                }
                10 if !poses.is_empty() && !places.is_empty() => {
                    let (pose, place) = (self.pick(&poses), self.pick(&places));
                    format!("[{place}.dot({pose} * [0, 1, 0]), dt({place}).dot({pose} * [1, 0, 0])]")
                }
                // Depends on what is given: ∂y/∂q̇ and ∂y/∂u.
                11 => {
                    let (force, length) = (self.input("N"), self.length(1));
                    format!("{force}*dt({length}) + {force}*{}*{}", self.plain(1), self.parameter([0, 1, -1]))
                }
                12 => format!("[{}/{}, {}]", self.input("N"), self.parameter([1, 1, -2]), self.plain_rate()),
                5 => format!("[{}, {}]{rate}", self.length(1), self.length(2)),
                6 => format!("{}*dt({})", self.parameter([1, 0, -1]), self.length(1)),
                7 if !places.is_empty() => format!("({} - {}).norm(){rate}", self.pick(&places), self.vector(0)),
                _ => format!("{}{rate}", self.plain(3)),
            };
            self.say(format!("output {name} = {statement};"));
        }
    }
}
