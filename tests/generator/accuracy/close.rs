//! Mechanisms whose parts touch, each with a place where they do.

use mbs_derive::model::Lagrangian;
use mbs_derive::numeric::Random;

use super::measure::states::{self, Point, state};

/// A mechanism, the coordinates at which distances vanish.
pub(crate) struct Close {
    pub(crate) name: &'static str,
    pub(crate) source: &'static str,
    pub(crate) contact: &'static [f64],
    /// Whether its forces are products of differences of inputs.
    pub(crate) is_exact: bool,
}

/// Springs and distances in frames that turn and move, and springs that are stiff.
pub(crate) const CLOSE: &[Close] = &[
    Close { name: "turntable_with_pin", source: TURNTABLE_WITH_PIN, contact: &[0.7, 0.5, 0.2], is_exact: false },
    Close { name: "turntable_typed", source: TURNTABLE_TYPED, contact: &[0.7, 0.5, 0.2], is_exact: false },
    Close { name: "station", source: STATION, contact: &[10.0, 2.0, 0.0], is_exact: false },
    Close {
        name: "hands",
        source: HANDS,
        contact: &[0.3, -0.2, 0.4, 0.339_836_909_454_121_9, -0.339_836_909_454_121_9],
        is_exact: false,
    },
    Close {
        name: "two_arms",
        source: TWO_ARMS,
        contact: &[0.339_836_909_454_121_9, -0.339_836_909_454_121_9],
        is_exact: false,
    },
    Close { name: "stiff_spring", source: STIFF_SPRING, contact: &[0.1], is_exact: true },
    Close { name: "stiff_net", source: STIFF_NET, contact: &[0.2, 0.3, 0.2, 0.3], is_exact: false },
    Close { name: "offset_puck", source: OFFSET_PUCK, contact: &[0.7, 0.5], is_exact: false },
    Close {
        name: "governor",
        source: GOVERNOR,
        contact: &[0.339_836_909_454_121_9, -0.339_836_909_454_121_9, 0.2, 0.4, -0.3],
        is_exact: false,
    },
    Close { name: "flying_docking", source: FLYING_DOCKING, contact: &[1.0e7, 2.0e7, 0.3, 0.4, 0.0], is_exact: false },
];

/// Points around a contact: at it, and 1e-9, 1e-6 and 1e-3 away from it.
pub(crate) fn near(lagrangian: &Lagrangian<'_>, contact: &[f64]) -> Vec<Point> {
    let mut random = Random::new(0x0063_6c6f_7365);
    let declared: Vec<f64> =
        lagrangian.parameters.iter().flat_map(|p| &p.defaults).map(|default| default.to_f64()).collect();
    let distances = [0.0, states::CLOSE, states::CLOSE, 1e-6, 1e-3];
    let at = |distance: f64| {
        let mut state = state(lagrangian, &mut random);
        state.q = contact.iter().map(|q| q + distance * random.symmetric()).collect();
        Point { name: format!("{distance} from contact"), state, parameters: declared.clone() }
    };
    distances.map(at).into()
}

/// A puck on a turntable, on a spring to a pin on the table.
const TURNTABLE_WITH_PIN: &str = "
mechanism TurntableWithPin {
    param m: kg = 1;
    param j: kg*m^2 = 2;
    param k: N/m = 10;
    param c: N*s/m = 3;
    param rest: m = 0.1;
    param pin[2]: m = [0.5, 0.2];
    coord nu: rad;
    coord x: m;
    coord y: m;
    let table = rot_z(nu);
    let puck = table.point([x, y, 0]);
    let anchor = table.point([pin[0], pin[1], 0]);
    kinetic += 1/2*j*dt(nu)^2 + particle(m, puck);
    potential += spring(k, (puck - anchor).norm(), rest) + 1/2*k*(anchor - puck).norm_squared();
    dissipation += 1/2*c*(dt(puck) - dt(anchor)).norm_squared();
    output d = (puck - anchor).norm();
    output by_components = hypot(puck.x - anchor.x, puck.y - anchor.y);
}";

/// The puck on a turntable, typed by sines and cosines.
const TURNTABLE_TYPED: &str = "
mechanism TurntableTyped {
    param m: kg = 1;
    param j: kg*m^2 = 2;
    param k: N/m = 10;
    param rest: m = 0.1;
    param pin[2]: m = [0.5, 0.2];
    coord nu: rad;
    coord x: m;
    coord y: m;
    let puck = [x*cos(nu) - y*sin(nu), x*sin(nu) + y*cos(nu), 0];
    let anchor = [pin[0]*cos(nu) - pin[1]*sin(nu), pin[0]*sin(nu) + pin[1]*cos(nu), 0];
    kinetic += 1/2*j*dt(nu)^2 + particle(m, puck);
    potential += spring(k, (puck - anchor).norm(), rest) + 1/2*k*(puck - anchor).norm_squared();
    output d = (puck - anchor).norm();
}";

/// A vehicle near a port of a station in orbit: a weak spring leads it to the port.
const STATION: &str = "
mechanism Station {
    param m: kg = 100;
    param radius: m = 7e6;
    param n: rad/s = 1.078e-3;
    param k: N/m = 1;
    param rest: m = 0.5;
    param port[3]: m = [10, 2, 0];
    coord r[3]: m;
    let station = rot_z(n*t) * translation([radius, 0, 0]);
    let place = station.point(r);
    kinetic += particle(m, place);
    potential += spring(k, (place - station.point(port)).norm(), rest);
    output d = (place - station.point(port)).norm();
    output seen = (station.inverse()*place - port).norm();
}";

/// A floating trunk with two arms; the hands hold a short spring.
const HANDS: &str = "
mechanism Hands {
    param m: kg = 1;
    param k: N/m = 1e4;
    param rest: m = 0.01;
    param l: m = 0.6;
    param w: m = 0.4;
    coord x: m;
    coord z: m;
    coord phi: rad;
    coord q[2]: rad;
    let trunk = translation([x, 0, z]) * rot_y(phi);
    kinetic += rigid_body(10*m, [0, 0, 0], diag(1, 1, 1)*m*l^2, trunk);
    let a = trunk * translation([w/2, 0, 0]) * rot_y(q[0]);
    let b = trunk * translation([-w/2, 0, 0]) * rot_y(q[1]);
    let ha = a.point([0, 0, -l]);
    let hb = b.point([0, 0, -l]);
    kinetic += particle(m, ha) + particle(m, hb);
    potential += spring(k, (ha - hb).norm(), rest);
    output d = (ha - hb).norm();
}";

/// The same two arms on a wall, which is short enough for the form of a textbook.
const TWO_ARMS: &str = "
mechanism TwoArms {
    param m: kg = 1;
    param k: N/m = 1e4;
    param rest: m = 0.01;
    param l: m = 0.6;
    param w: m = 0.4;
    coord q[2]: rad;
    let ha = (translation([w/2, 0, 0]) * rot_y(q[0])).point([0, 0, -l]);
    let hb = (translation([-w/2, 0, 0]) * rot_y(q[1])).point([0, 0, -l]);
    kinetic += particle(m, ha) + particle(m, hb);
    potential += spring(k, (ha - hb).norm(), rest) + 1/2*k*(ha - hb).norm_squared();
    output d = (ha - hb).norm();
}";

/// A stiff spring, nearly relaxed.
const STIFF_SPRING: &str = "
mechanism StiffSpring {
    param m: kg = 1;
    param k: N/m = 1e9;
    param rest: m = 0.1;
    param gain: N/m = 1e9;
    coord r: m;
    kinetic += 1/2*m*dt(r)^2;
    potential += spring(k, r, rest);
    force r += gain*(rest - r);
}";

/// Two masses on stiff springs to the ground and to each other.
const STIFF_NET: &str = "
mechanism StiffNet {
    param m: kg = 1;
    param k: N/m = 1e9;
    param c: N*s/m = 1e6;
    param place[2]: m = [0.2, 0.3];
    param rest: m = 1e-6;
    coord a[2]: m;
    coord b[2]: m;
    kinetic += particle(m, [a[0], a[1], 0]) + particle(2*m, [b[0], b[1], 0]);
    potential += spring(k, hypot(a[0] - b[0], a[1] - b[1]), rest);
    potential += spring(k, a[0], place[0]) + 1/2*k*(b[1] - place[1])^2 + 1/2*k*(a[0] - place[0])*(b[0] - place[0]);
    dissipation += 1/2*c*((dt(a[0]) - dt(b[0]))^2 + (dt(a[1]) - dt(b[1]))^2);
}";

/// A puck in a groove of a turntable without inertia, its place counted from an end of the groove.
const OFFSET_PUCK: &str = "
mechanism OffsetPuck {
    param m: kg = 1;
    param centre: m = 0.5;
    coord nu: rad;
    coord x: m;
    let table = rot_z(nu);
    kinetic += particle(m, table.point([x - centre, 0, 0]));
}";

/// Kinetic energies that distances are in: of turns whose radius is the distance of two hands, and of a hand from a
/// wall.
const GOVERNOR: &str = "
mechanism Governor {
    param m: kg = 1;
    param l: m = 0.6;
    param w: m = 0.4;
    coord q[2]: rad;
    coord x: m;
    coord turns[2]: rad;
    let ha = (translation([w/2, 0, 0]) * rot_y(q[0])).point([0, 0, -l]);
    let hb = (translation([-w/2, 0, 0]) * rot_y(q[1])).point([0, 0, -l]);
    kinetic += 1/2*m*l^2*(dt(q[0])^2 + dt(q[1])^2) + 1/2*m*dt(x)^2;
    kinetic += 1/2*m*(ha - hb).norm_squared()*dt(turns[0])^2 + 1/2*m*(l*sin(q[0]) - x)^2*dt(turns[1])^2;
}";

/// Far from the origin a craft reaches for a port that it carries along.
const FLYING_DOCKING: &str = "
mechanism FlyingDocking {
    param m: kg = 10;
    param k: N/m = 1e9;
    param rest: m = 0;
    param port[2]: m = [0.4, 0];
    coord x: m;
    coord y: m;
    coord heading: rad;
    coord u: m;
    coord v: m;
    let craft = translation([x, y, 0]) * rot_z(heading);
    let probe = craft.point([u, v, 0]);
    kinetic += rigid_body(10*m, [0, 0, 0], diag(1, 1, 1)*m*port[0]^2, craft) + particle(m, probe);
    potential += spring(k, (probe - craft.point([port[0], port[1], 0])).norm(), rest);
    output gap = (probe - craft.point([port[0], port[1], 0])).norm();
}";
