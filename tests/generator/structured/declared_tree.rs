//! Trees of bodies at random: as proptest generates and shrinks them, as text of the model language, and as the tree
//! that judges what is derived from it.

use std::fmt::Write;

use mbs_tests::random::Random;
use mbs_tests::reference::tree::{Body, Law, Motion, Node, Place, Tree};
use proptest::prelude::*;

/// A tree in the making: numbers are as they are declared.
#[derive(Clone, Debug)]
pub(crate) struct DeclaredTree {
    links: Vec<Link>,
    gravity: [f64; 3],
    /// Masses, mass centres, inertias, shifts and gravity as parameters, not as numbers.
    with_parameters: bool,
}

#[derive(Clone, Debug)]
struct Link {
    /// Counted back from this link; beyond the first one is the world.
    back: usize,
    place: Place,
    edge: Edge,
    mass: Mass,
    /// By world positions and world angular velocities, not by `rigid_body`.
    in_world_axes: bool,
}

#[derive(Clone, Debug)]
enum Edge {
    Fixed,
    Turn([f64; 3], Variable),
    Slide([f64; 3], Variable),
    /// Three slides and a turn by three angles or by a quaternion. A tree has one at most; further ones are fixed.
    Free {
        quaternion: bool,
    },
}

/// What a hinge or a slide moves with. Coordinates are counted round among those that there are already; where there
/// are none, the joint has one of its own.
#[derive(Clone, Debug)]
enum Variable {
    /// A coordinate of its own.
    Own,
    /// A coordinate of its own, and another joint's.
    Sum { ratio: f64, other: usize, other_ratio: f64 },
    /// Another joint's.
    Geared { other: usize, ratio: f64 },
    /// A coordinate of its own, bent: `z + bend z²`.
    Bent { offset: f64, bend: f64 },
    /// A signal, given at run time.
    Signal,
    /// A signal, and a coordinate of its own.
    OwnAndSignal,
    /// A sine of time.
    Sine { amplitude: f64, frequency: f64 },
}

#[derive(Clone, Debug)]
enum Mass {
    None,
    Particle { mass: f64, center: [f64; 3] },
    Rigid { mass: f64, center: [f64; 3], offsets: [[f64; 3]; 3] },
}

/// Trees of 1 to 12 bodies.
pub(crate) fn declared_tree() -> impl Strategy<Value = DeclaredTree> {
    let links = prop_oneof![
        4 => prop::collection::vec(link(), 1..=4),
        4 => prop::collection::vec(link(), 5..=8),
        1 => prop::collection::vec(link(), 9..=12),
    ];
    let gravity = prop_oneof![3 => vector(9000), 1 => Just([0.0, 0.0, -9.81]), 1 => Just([0.0; 3])];
    (links, gravity, prop::bool::weighted(0.3)).prop_map(|(links, gravity, with_parameters)| DeclaredTree {
        links,
        gravity,
        with_parameters,
    })
}

fn link() -> impl Strategy<Value = Link> {
    let back = prop_oneof![4 => Just(1_usize), 1 => 2..5_usize];
    (back, place(), edge(), mass(), any::<bool>()).prop_map(|(back, place, edge, mass, in_world_axes)| Link {
        back,
        place,
        edge,
        mass,
        in_world_axes,
    })
}

fn place() -> impl Strategy<Value = Place> {
    let angle = prop_oneof![Just(0.0), Just(90.0), Just(-90.0), (-179..180_i32).prop_map(f64::from)];
    let turned = (axis(), angle);
    (vector(500), turned).prop_map(|(shift, (axis, degrees))| Place { shift, axis, angle: f64::to_radians(degrees) })
}

fn edge() -> impl Strategy<Value = Edge> {
    prop_oneof![
        1 => Just(Edge::Fixed),
        6 => (axis(), variable()).prop_map(|(axis, variable)| Edge::Turn(axis, variable)),
        3 => (axis(), variable()).prop_map(|(axis, variable)| Edge::Slide(axis, variable)),
        1 => any::<bool>().prop_map(|quaternion| Edge::Free { quaternion }),
    ]
}

fn variable() -> impl Strategy<Value = Variable> {
    let ratio = || (-20..20_i32).prop_map(|k| if k == 0 { 1.0 } else { f64::from(k) / 8.0 });
    prop_oneof![
        12 => Just(Variable::Own),
        2 => (ratio(), 0..32_usize, ratio())
            .prop_map(|(ratio, other, other_ratio)| Variable::Sum { ratio, other, other_ratio }),
        2 => (0..32_usize, ratio()).prop_map(|(other, ratio)| Variable::Geared { other, ratio }),
        1 => (milli(400), milli(100)).prop_map(|(offset, bend)| Variable::Bent { offset, bend }),
        1 => Just(Variable::Signal),
        1 => Just(Variable::OwnAndSignal),
        1 => (milli(900), milli(3000)).prop_map(|(amplitude, frequency)| Variable::Sine { amplitude, frequency }),
    ]
}

fn mass() -> impl Strategy<Value = Mass> {
    let mass = || (100..5000_i32).prop_map(|k| f64::from(k) / 1000.0);
    let offsets = [(); 3].map(|()| vector(200));
    prop_oneof![
        1 => Just(Mass::None),
        1 => (mass(), vector(300)).prop_map(|(mass, center)| Mass::Particle { mass, center }),
        6 => (mass(), vector(300), offsets).prop_map(|(mass, center, offsets)| Mass::Rigid { mass, center, offsets }),
    ]
}

/// Skew, sparse or zero, in thousandths.
fn vector(most: i32) -> impl Strategy<Value = [f64; 3]> {
    let along = |k: usize| milli(most).prop_map(move |c| std::array::from_fn(|i| if i == k { c } else { 0.0 }));
    prop_oneof![1 => Just([0.0; 3]), 1 => along(0), 1 => along(2), 6 => [milli(most), milli(most), milli(most)]]
}

/// Not zero; most of them skew.
fn axis() -> impl Strategy<Value = [f64; 3]> {
    let nonzero = |v: [f64; 3]| if v == [0.0; 3] { [0.0, 0.0, 1.0] } else { v };
    let along = |k: usize| Just(std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }));
    prop_oneof![1 => along(0), 1 => along(1), 1 => along(2), 7 => vector(1000).prop_map(nonzero)]
}

fn milli(most: i32) -> impl Strategy<Value = f64> {
    (-most..=most).prop_map(|k| f64::from(k) / 1000.0)
}

/// Numbers and kinds of variables, given out one after the other.
#[derive(Default)]
struct Variables {
    /// Names of scalar coordinates, of which other joints may take more.
    scalars: Vec<usize>,
    coordinates: usize,
    quaternion: Option<usize>,
    signals: usize,
    /// Amplitude and frequency.
    sines: Vec<[f64; 2]>,
    free: bool,
}

/// A variable as it is numbered while the tree is read.
#[derive(Clone, Copy)]
enum Number {
    Coordinate(usize),
    Signal(usize),
    Sine(usize),
}

/// One elementary motion of a link, before variables are numbered through.
enum Step {
    Turn([f64; 3], f64, Vec<(Number, f64)>, f64),
    Slide([f64; 3], f64, Vec<(Number, f64)>, f64),
    Quaternion(usize),
}

impl Variables {
    fn own(&mut self) -> Number {
        self.scalars.push(self.coordinates);
        self.coordinates += 1;
        Number::Coordinate(self.coordinates - 1)
    }

    fn other(&mut self, choice: usize) -> Number {
        match self.scalars.len() {
            0 => self.own(),
            count => Number::Coordinate(self.scalars[choice % count]),
        }
    }

    fn signal(&mut self) -> Number {
        self.signals += 1;
        Number::Signal(self.signals - 1)
    }

    /// Offset, terms and bend of a joint's law.
    fn law(&mut self, variable: &Variable) -> (f64, Vec<(Number, f64)>, f64) {
        let terms = match *variable {
            Variable::Own => vec![(self.own(), 1.0)],
            Variable::Sum { ratio, other, other_ratio } => match self.scalars.is_empty() {
                true => vec![(self.own(), ratio)],
                false => {
                    let other = self.other(other);
                    vec![(self.own(), ratio), (other, other_ratio)]
                }
            },
            Variable::Geared { other, ratio } => vec![(self.other(other), ratio)],
            Variable::Bent { offset, bend } => return (offset, vec![(self.own(), 1.0)], bend),
            Variable::Signal => vec![(self.signal(), 1.0)],
            Variable::OwnAndSignal => vec![(self.own(), 1.0), (self.signal(), 1.0)],
            Variable::Sine { amplitude, frequency } => {
                self.sines.push([amplitude, frequency]);
                vec![(Number::Sine(self.sines.len() - 1), 1.0)]
            }
        };
        (0.0, terms, 0.0)
    }

    fn steps(&mut self, edge: &Edge) -> Vec<Step> {
        match edge {
            Edge::Fixed => Vec::new(),
            Edge::Turn(axis, variable) => {
                let (offset, terms, bend) = self.law(variable);
                vec![Step::Turn(*axis, offset, terms, bend)]
            }
            Edge::Slide(axis, variable) => {
                let (offset, terms, bend) = self.law(variable);
                vec![Step::Slide(unit(*axis), offset, terms, bend)]
            }
            Edge::Free { .. } if std::mem::replace(&mut self.free, true) => Vec::new(),
            Edge::Free { quaternion } => {
                let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                let mut steps: Vec<Step> =
                    axes.iter().map(|axis| Step::Slide(*axis, 0.0, vec![(self.own(), 1.0)], 0.0)).collect();
                if *quaternion {
                    self.quaternion = Some(self.coordinates);
                    steps.push(Step::Quaternion(self.coordinates));
                    self.coordinates += 4;
                } else {
                    let turns = [axes[2], axes[1], axes[0]];
                    steps.extend(turns.map(|axis| Step::Turn(axis, 0.0, vec![(self.own(), 1.0)], 0.0)));
                }
                steps
            }
        }
    }

    /// Where a variable stands among those of the tree.
    fn place(&self, number: Number) -> usize {
        match number {
            Number::Coordinate(k) => k,
            Number::Signal(k) => self.coordinates + k,
            Number::Sine(k) => self.coordinates + self.signals + k,
        }
    }
}

impl DeclaredTree {
    /// The same tree with other masses, mass centres, inertias, shifts and gravity, where these are parameters.
    pub(crate) fn varied(&self, seed: u64) -> Self {
        let mut tree = self.clone();
        if !self.with_parameters {
            return tree;
        }
        let mut random = Random::new(seed);
        let mut vary = |value: &mut f64| *value *= 1.0 + random.uniform(-0.2..0.2);
        tree.gravity.iter_mut().for_each(&mut vary);
        for link in &mut tree.links {
            link.place.shift.iter_mut().for_each(&mut vary);
            match &mut link.mass {
                Mass::None => {}
                Mass::Particle { mass, center } => [mass].into_iter().chain(center).for_each(&mut vary),
                Mass::Rigid { mass, center, offsets } => {
                    [mass].into_iter().chain(center).chain(offsets.iter_mut().flatten()).for_each(&mut vary);
                }
            }
        }
        tree
    }

    /// Values of the parameters in the order of their declaration.
    pub(crate) fn parameters(&self) -> Vec<f64> {
        if !self.with_parameters {
            return Vec::new();
        }
        let bodies: Vec<Body> = self.links.iter().map(|link| link.mass.body().unwrap_or(NOTHING)).collect();
        let mut values = self.gravity.to_vec();
        values.extend(self.links.iter().flat_map(|link| link.place.shift));
        values.extend(bodies.iter().map(|body| body.mass));
        values.extend(bodies.iter().flat_map(|body| body.center));
        values.extend(bodies.iter().flat_map(|body| body.inertia));
        values
    }

    /// Values and derivatives of the sines of time.
    pub(crate) fn formulas(&self, t: f64) -> Vec<[f64; 3]> {
        let (_, variables) = self.steps();
        let sine = |[a, w]: &[f64; 2]| [a * (w * t).sin(), a * w * (w * t).cos(), -a * w * w * (w * t).sin()];
        variables.sines.iter().map(sine).collect()
    }

    /// As the reference has it.
    pub(crate) fn tree(&self) -> Tree {
        let (steps, variables) = self.steps();
        let mut nodes: Vec<Node> = Vec::new();
        let mut last_of_link = Vec::new();
        for (i, (link, steps)) in self.links.iter().zip(&steps).enumerate() {
            let mut parent = self.parent(i).map(|parent: usize| last_of_link[parent]);
            let mut push = |place, motion, body| {
                nodes.push(Node { parent, place, motion, body });
                parent = Some(nodes.len() - 1);
            };
            push(link.place, Motion::Fixed, None);
            for step in steps {
                let law = |offset, terms: &[(Number, f64)], bend| {
                    let terms = terms.iter().map(|(number, ratio)| (variables.place(*number), *ratio)).collect();
                    Law { offset, terms, bend }
                };
                let motion = match step {
                    Step::Turn(axis, offset, terms, bend) => Motion::Turn(*axis, law(*offset, terms, *bend)),
                    Step::Slide(axis, offset, terms, bend) => Motion::Slide(*axis, law(*offset, terms, *bend)),
                    Step::Quaternion(first) => Motion::Ball { first: *first },
                };
                push(Place::HERE, motion, None);
            }
            push(Place::HERE, Motion::Fixed, link.mass.body());
            last_of_link.push(nodes.len() - 1);
        }
        Tree {
            coordinates: variables.coordinates,
            signals: variables.signals + variables.sines.len(),
            nodes,
            gravity: self.gravity,
            drives: Vec::new(),
        }
    }

    /// As text of the model language.
    pub(crate) fn text(&self) -> String {
        let (steps, variables) = self.steps();
        let mut text = String::from("#![dimensionless]\nmechanism RandomTree {\n");
        let n = variables.coordinates;
        text += &self.parameter_text();
        writeln!(text, "    coord q[{n}]: 1;\n    input tau[{n}]: 1;\n    force q += tau;").expect("a string");
        if variables.signals > 0 {
            writeln!(text, "    prescribed signal[{}]: 1;", variables.signals).expect("a string");
        }
        for (k, [amplitude, frequency]) in variables.sines.iter().enumerate() {
            writeln!(text, "    prescribed sine{k}: 1 = {amplitude:?}*sin({frequency:?}*t);").expect("a string");
        }
        if let Some(first) = variables.quaternion {
            let squares: Vec<String> = (first..first + 4).map(|k| format!("q[{k}]^2")).collect();
            writeln!(text, "    constraint unit: {} = 1;", squares.join(" + ")).expect("a string");
        }
        let number = |vector: [f64; 3]| format!("[{:?}, {:?}, {:?}]", vector[0], vector[1], vector[2]);
        let gravity = if self.with_parameters { "gravity".to_string() } else { number(self.gravity) };
        writeln!(text, "    let g = {gravity};").expect("a string");
        for (i, (link, steps)) in self.links.iter().zip(&steps).enumerate() {
            let parent = self.parent(i).map_or("world".to_string(), |parent| format!("link{parent}"));
            let shift = if self.with_parameters { components("shift", i) } else { number(link.place.shift) };
            let mut pose = format!("{parent} * translation({shift})");
            if link.place.angle != 0.0 {
                let degrees = link.place.angle.to_degrees().round();
                write!(pose, " * rotation({}, {degrees}*deg)", number(link.place.axis)).expect("a string");
            }
            for step in steps {
                write!(pose, " * {}", step_text(step)).expect("a string");
            }
            writeln!(text, "    let link{i} = {pose};\n{}", self.mass_text(i, link)).expect("a string");
        }
        text + "}\n"
    }

    /// Statements that load its links: forces and torques in axes of the world and of the link, springs, drag, dampers.
    /// Some may be refused, where no coordinate moves the link.
    pub(crate) fn loads(&self) -> Vec<String> {
        let of = |i: usize| {
            let point = format!("link{i}.point([0.1, {i}, -0.3])");
            vec![
                format!("force at {point} += [3, -1, q[0]];"),
                format!("force at {point} += link{i}*[tau[0], 2, {i}];"),
                format!("torque on link{i} += [0.5, {i}, 2];"),
                format!("torque on link{i} += link{i}*[1, tau[0], -{i}];"),
                format!("potential += 7*({point} - [1, {i}, t]).norm_squared();"),
                format!("potential += 1/4*({point} - world.point([-2, 1, 3])).norm_squared()^2;"),
                format!("potential += spring(5, ({point} - link0.point([2, -8, 9])).norm(), 2);"),
                format!("dissipation += 3*dt({point}).norm_squared();"),
                format!("dissipation += 2*angular_velocity(link{i}).norm_squared();"),
                format!("dissipation += 1/2*dt(({point} - link0.point([2, -8, 9])).norm())^2;"),
                format!("dissipation += dt({point} - [1, t, {i}]).norm_squared()^2/7 + 2*dt({point}).x^2;"),
            ]
        };
        (0..self.links.len()).flat_map(of).collect()
    }

    fn parameter_text(&self) -> String {
        if !self.with_parameters {
            return String::new();
        }
        let n = self.links.len();
        let counts = [("gravity", 3), ("shift", 3 * n), ("mass", n), ("com", 3 * n), ("moments", 6 * n)];
        let mut values = self.parameters().into_iter();
        let mut declare = |(name, count): (&str, usize)| {
            let values: Vec<String> = values.by_ref().take(count).map(|value| format!("{value:?}")).collect();
            format!("    param {name}[{count}]: 1 = [{}];\n", values.join(", "))
        };
        counts.map(&mut declare).concat()
    }

    /// Energies of link i's body.
    fn mass_text(&self, i: usize, link: &Link) -> String {
        let Some(Body { mass, center: [x, y, z], inertia }) = link.mass.body() else { return String::new() };
        let (mass, center, moments) = if self.with_parameters {
            let moments: Vec<String> = (0..6).map(|k| format!("moments[{}]", 6 * i + k)).collect();
            (format!("mass[{i}]"), components("com", i), moments.join(", "))
        } else {
            let moments: Vec<String> = inertia.iter().map(|moment| format!("{moment:?}")).collect();
            (format!("{mass:?}"), format!("[{x:?}, {y:?}, {z:?}]"), moments.join(", "))
        };
        let place = format!("    let place{i} = link{i}.point({center});\n");
        let rigid = matches!(link.mass, Mass::Rigid { .. });
        let kinetic = match (link.in_world_axes, rigid) {
            (false, false) => format!("    kinetic += particle({mass}, place{i});\n"),
            (false, true) => format!("    kinetic += rigid_body({mass}, {center}, inertia({moments}), link{i});\n"),
            (true, false) => format!("    kinetic += 1/2*{mass}*dt(place{i}).norm_squared();\n"),
            (true, true) => format!(
                "    kinetic += 1/2*{mass}*dt(place{i}).norm_squared();\n    let w{i} = angular_velocity(link{i});\n    \
                 kinetic += 1/2*w{i}.dot((link{i}*inertia({moments}))*w{i});\n"
            ),
        };
        let potential = match link.in_world_axes {
            true => format!("    potential += -{mass}*g.dot(place{i});\n"),
            false => format!("    potential += -{mass}*(g.x*place{i}.x + g.y*place{i}.y + g.z*place{i}.z);\n"),
        };
        place + &kinetic + &potential
    }

    fn steps(&self) -> (Vec<Vec<Step>>, Variables) {
        let mut variables = Variables::default();
        let steps = self.links.iter().map(|link| variables.steps(&link.edge)).collect();
        (steps, variables)
    }

    fn parent(&self, i: usize) -> Option<usize> {
        i.checked_sub(self.links[i].back)
    }
}

const NOTHING: Body = Body { mass: 0.0, center: [0.0; 3], inertia: [0.0; 6] };

impl Mass {
    /// A rigid body's inertia is that of three equal masses at the offsets, about the body's mass centre, and of a
    /// small ball: no choice of numbers can violate the triangle inequality.
    fn body(&self) -> Option<Body> {
        match *self {
            Mass::None => None,
            Mass::Particle { mass, center } => Some(Body { mass, center, inertia: [0.0; 6] }),
            Mass::Rigid { mass, center, offsets } => {
                let sum = |term: fn([f64; 3]) -> f64| mass / 3.0 * offsets.iter().map(|r| term(*r)).sum::<f64>();
                let ball = 0.001 * mass;
                let inertia = [
                    ball + sum(|[_, y, z]| y * y + z * z),
                    ball + sum(|[x, _, z]| x * x + z * z),
                    ball + sum(|[x, y, _]| x * x + y * y),
                    sum(|[x, y, _]| -x * y),
                    sum(|[x, _, z]| -x * z),
                    sum(|[_, y, z]| -y * z),
                ];
                Some(Body { mass, center, inertia })
            }
        }
    }
}

fn step_text(step: &Step) -> String {
    let law = |offset: &f64, terms: &[(Number, f64)], bend: &f64| {
        let name = |number: Number| match number {
            Number::Coordinate(k) => format!("q[{k}]"),
            Number::Signal(k) => format!("signal[{k}]"),
            Number::Sine(k) => format!("sine{k}"),
        };
        let term = |(number, ratio): &(Number, f64)| match *ratio {
            1.0 => name(*number),
            ratio => format!("({ratio:?})*{}", name(*number)),
        };
        let sum = terms.iter().map(term).collect::<Vec<_>>().join(" + ");
        let z = if *offset == 0.0 { sum } else { format!("({offset:?} + {sum})") };
        if *bend == 0.0 { z } else { format!("{z} + ({bend:?})*({z})^2") }
    };
    match step {
        Step::Turn([x, y, z], offset, terms, bend) => {
            format!("rotation([{x:?}, {y:?}, {z:?}], {})", law(offset, terms, bend))
        }
        Step::Slide(axis, offset, terms, bend) => {
            let way = law(offset, terms, bend);
            let components: Vec<String> = axis.iter().map(|c| format!("{c:?}*({way})")).collect();
            format!("translation([{}])", components.join(", "))
        }
        Step::Quaternion(first) => {
            format!("quaternion(q[{first}], q[{}], q[{}], q[{}])", first + 1, first + 2, first + 3)
        }
    }
}

/// The three components that belong to link i.
fn components(name: &str, i: usize) -> String {
    format!("[{name}[{}], {name}[{}], {name}[{}]]", 3 * i, 3 * i + 1, 3 * i + 2)
}

fn unit(axis: [f64; 3]) -> [f64; 3] {
    let length = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
    axis.map(|c| c / length)
}
