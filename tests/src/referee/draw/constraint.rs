//! Constraints: coordinates that are carried by others, closed loops, bodies that roll.

use super::{Draw, Measure};

impl Draw {
    /// Each ties a coordinate of its own to the others, so that rows are independent.
    pub(super) fn constraints(&mut self) {
        let count = 1 + usize::from(self.chance(30));
        for _ in 0..count {
            let name = self.fresh("tie");
            let others = self.coordinates.clone();
            let measure = if self.chance(50) { Measure::Length } else { Measure::Angle };
            let value = if measure == Measure::Length { self.length(2) } else { self.plain(2) };
            let other = self.pick(&others);
            let factor = match (measure, other.measure) {
                (Measure::Length, Measure::Angle) => format!("{}*", self.parameter([0, 1, 0])),
                (Measure::Angle, Measure::Length) => format!("1/{}*", self.parameter([0, 1, 0])),
                _ => String::new(),
            };
            let plain = self.plain(1);
            let coordinate = self.coordinate(measure);
            // None of its own, or some that vanishes at some places: then M is singular.
            match self.below(4) {
                0 | 1 => self.own_inertia(&coordinate, measure),
                2 => self.vanishing_inertia(&coordinate, measure),
                _ => {}
            }
            let statement = match self.below(4) {
                0 => format!("dt({coordinate}) = {factor}{plain}*dt({})", other.name),
                1 => format!("0 = dt({coordinate}) - {factor}{plain}*dt({})", other.name),
                2 => format!("{coordinate} = {value}"),
                _ => format!("{coordinate} - {value} = 0"),
            };
            self.say(format!("constraint {name}: {statement};"));
        }
    }

    fn vanishing_inertia(&mut self, coordinate: &str, measure: Measure) {
        let inertia = self.parameter(if measure == Measure::Length { [1, 0, 0] } else { [1, 2, 0] });
        let factor = self.plain(1);
        self.say(format!("kinetic += 1/2*{inertia}*({factor})^2*dt({coordinate})^2;"));
    }

    /// A moving body on a new pose.
    fn member(&mut self, pose: &str) -> String {
        let name = self.fresh("member");
        self.say(format!("let {name} = {pose};"));
        self.body(&name);
        self.turning.push(name.clone());
        self.poses.push(name.clone());
        name
    }

    /// Loops that a constraint closes, and rows that depend on others where it holds.
    pub(super) fn closures(&mut self) {
        match self.below(3) {
            0 => self.four_bar(),
            1 => self.carried_body(),
            _ => self.hinged_coupler(),
        }
    }

    fn four_bar(&mut self) {
        let (turn, axis) = self.pick(&[("rot_x", "[0, #, 0]"), ("rot_y", "[#, 0, 0]"), ("rot_z", "[0, #, 0]")]);
        let (a, b, c) =
            (self.coordinate(Measure::Angle), self.coordinate(Measure::Angle), self.coordinate(Measure::Angle));
        let [first, second, third, ground] = std::array::from_fn(|_| axis.replace('#', &self.parameter([0, 1, 0])));
        let crank = self.member(&format!("{turn}({a})"));
        let coupler = self.member(&format!("{crank} * translation({first}) * {turn}({b})"));
        let rocker = self.member(&format!("translation({ground}) * {turn}(-{c})"));
        let name = self.fresh("close");
        let point = self
            .pick(&["coupler.point(second) = rocker.point(third)", "0 = coupler.point(second) - rocker.point(third)"]);
        let [coupler_point, rocker_point] = [format!("{coupler}.point({second})"), format!("{rocker}.point({third})")];
        let point =
            point.replace("coupler.point(second)", &coupler_point).replace("rocker.point(third)", &rocker_point);
        self.say(format!("constraint {name}: {point};"));
    }

    /// A body with six coordinates, of which a pin takes three.
    fn carried_body(&mut self) {
        let pose = if self.poses.is_empty() { "world".to_string() } else { self.pick(&self.poses.clone()) };
        let body = self.free_member();
        let (pin, place) = (self.fresh("pin"), self.fixed_vector([0, 1, 0]));
        let end = if self.chance(50) { "[0, 0, 0]".to_string() } else { self.fixed_vector([0, 1, 0]) };
        self.say(format!("constraint {pin}: {pose}.point({place}) = {body}.point({end});"));
    }

    fn free_member(&mut self) -> String {
        let lengths: [String; 3] = std::array::from_fn(|_| self.coordinate(Measure::Length));
        let angles: [String; 3] = std::array::from_fn(|_| self.coordinate(Measure::Angle));
        let ([x, y, z], [a, b, c]) = (lengths, angles);
        self.member(&format!("translation([{x}, {y}, {z}]) * rot_z({a}) * rot_y({b}) * rot_x({c})"))
    }

    /// A hinge declared in full: by a common point and a common axis, or by two points of it. One row of six follows
    /// from the others where they hold, and only there.
    fn hinged_coupler(&mut self) {
        let (a, b) = (self.coordinate(Measure::Angle), self.coordinate(Measure::Angle));
        let crank = self.member(&format!("rot_x({a}) * rot_y({b})"));
        let body = self.free_member();
        let (pin, axis, place) = (self.fresh("pin"), self.fresh("axis"), self.fixed_vector([0, 1, 0]));
        self.say(format!("constraint {pin}: {crank}.point({place}) = {body}.origin();"));
        if self.chance(50) {
            self.say(format!("constraint {axis}: ({crank}*[0, 0, 1]).cross({body}*[0, 0, 1]) = 0;"));
        } else {
            let height = self.parameter([0, 1, 0]);
            let end = format!("{crank}.point({place}) + {crank}*[0, 0, {height}]");
            self.say(format!("constraint {axis}: {end} = {body}.point([0, 0, {height}]);"));
        }
    }

    /// A wheel, a ball or a blade.
    pub(super) fn rolling(&mut self) {
        let (x, y) = (self.coordinate(Measure::Length), self.coordinate(Measure::Length));
        let (a, b) = (self.coordinate(Measure::Angle), self.coordinate(Measure::Angle));
        let (radius, name) = (self.parameter([0, 1, 0]), self.fresh("rolls"));
        match self.below(3) {
            0 => {
                let spin = self.coordinate(Measure::Angle);
                let frame =
                    self.member(&format!("translation([{x}, {y}, {radius}*cos({b})]) * rot_z({a}) * rot_x({b})"));
                let disk = self.member(&format!("{frame} * rot_y({spin})"));
                let arm = format!("{frame}*[0, 0, -{radius}]");
                self.say(format!(
                    "constraint {name}: dt({disk}.origin()) + angular_velocity({disk}).cross({arm}) = 0;"
                ));
            }
            1 => {
                let c = self.coordinate(Measure::Angle);
                let turned = format!("translation([{x}, {y}, {radius}]) * rot_z({a}) * rot_y({b}) * rot_x({c})");
                let ball = self.member(&turned);
                let arm = format!("[0, 0, -{radius}]");
                self.say(format!("constraint {name}: dt({ball}.origin()) = -angular_velocity({ball}).cross({arm});"));
            }
            _ => {
                let sled = self.member(&format!("translation([{x}, {y}, 0]) * rot_z({a})"));
                self.own_inertia(&b, Measure::Angle);
                self.say(format!("constraint {name}: dt({sled}.origin()).dot({sled}*[0, 1, 0]) = {radius}*dt({b});"));
            }
        }
    }
}
