//! `mbs sweep` by compiled code and by the interpreter: the same bytes, and what is said of which.

use mbs_native::Compilers;

use crate::{Outcome, Workshop, constrained};

/// Whether there is a C compiler; says that the test skips where there is none.
fn has_compiler(test: &str) -> bool {
    let has = !Compilers::of_environment().found().is_empty();
    if !has {
        eprintln!("skipped: {test}, there is no C compiler");
    }
    has
}

/// A cart that a table pushes and a signal shakes, with friction that changes sign and a stop that is a spring.
const CART: &str = "\
mechanism Cart {
    param m: kg = 2;
    param k: N/m = 400;
    param c: N = 0.5;
    coord x: m;
    coord angle: rad;
    input push: N;
    input turn: N*m;
    prescribed shake: m;
    kinetic += 1/2*m*(dt(x) + dt(shake))^2 + 1/2*m*(0.3 m*dt(angle))^2 + m*0.3 m*cos(angle)*dt(x)*dt(angle)/4;
    potential += -m*9.81 m/s^2*0.3 m*cos(angle);
    let deep = if x > 0.2 m { x - 0.2 m } else { 0 m };
    force x += push - k*deep - c*tanh(dt(x)/(0.01 m/s));
    force angle += turn - if dt(angle) < 0 rad/s { 0.2 N*m*s/rad } else { 0.1 N*m*s/rad }*dt(angle);
    output depth = deep;
    output lift = 0.3*(1 - cos(angle)) + exp(-x/(1 m));
}
";

const PLAN: &str = "\
mechanism = \"cart.mbs\"
members = 6
seed = 9

[inputs]
push = \"@push.csv\"
turn = \"-gain*angle + if t < 0.4 s { 0.5 N*m } else { 0 N*m }\"

[signals]
shake = \"0.02*sin(7*t)\"

[parameters]
gain = \"1 N*m/rad\"

[vary]
m = { normal = [\"2 kg\", \"0.2 kg\"], within = [\"1 kg\", \"3 kg\"] }
angle_dot = { uniform = [-2, 2] }
x = { values = [0, \"0.3 m\"] }

[motion]
duration = \"1.5 s\"
until = { zero = \"x - far\", direction = \"rising\" }

[quantities]
time = { time_of = \"angle\" }
turns = { count = \"dt(angle)\" }
hit = { happened = \"depth\" }
deepest = { max = \"depth\" }
lowest = { min = \"lift\" }
work = { mean = \"push*dt(x)\" }
energy = \"energy\"
kinetic = { max = \"kinetic_energy\" }
";

/// The table of a plan by one engine, and what was said.
fn table(workshop: &Workshop, name: &str, options: &[&str]) -> (String, String) {
    let said = workshop.good(&[&["sweep", "plan.toml", "--out", name], options].concat());
    (workshop.read(name), said)
}

/// Both engines say who they are, and make the same bytes.
#[track_caller]
fn alike(workshop: &Workshop) -> String {
    let (compiled, said) = table(workshop, "compiled.csv", &[]);
    assert!(said.contains(" by compiled code on "), "{said}");
    let (interpreted, said) = table(workshop, "interpreted.csv", &["--interpret"]);
    assert!(said.contains(" by the interpreter on "), "{said}");
    assert!(compiled == interpreted, "{compiled}\n{interpreted}");
    compiled
}

/// Branches, tables, signals, events, outputs, functions of the library.
#[test]
fn both_engines_make_the_same_bytes() {
    if !has_compiler("both engines") {
        return;
    }
    let workshop = Workshop::new();
    workshop.write("cart.mbs", CART);
    workshop.write("push.csv", "t,push\n0,3\n0.5,-2\n1,4\n2,0\n");
    workshop.write("plan.toml", PLAN.replace("gain = ", "far = \"40 cm\"\ngain = "));
    let table = alike(&workshop);
    let stopped = table.lines().filter(|line| line.ends_with('"')).count();
    assert_eq!((table.lines().filter(|line| !line.starts_with('#')).count(), stopped), (13, 0), "{table}");
}

/// Constraints that depend on others, projected, by the runtime's factorization.
#[test]
fn both_engines_make_the_same_bytes_on_redundant_constraints() {
    if !has_compiler("both engines on constraints") {
        return;
    }
    let workshop = Workshop::new();
    workshop.write("parallel.mbs", constrained::PARALLEL);
    let plan = "mechanism = \"parallel.mbs\"\n[fixed]\na_0 = 1\na_1 = 1\na_2 = 1\nx = 0.7701511529340698\n\
                z = 0.42073549240394825\n[vary]\nm = { values = [1, 2] }\n[motion]\nduration = 0.5\n\
                redundant = \"least-norm\"\n[quantities]\nenergy = \"energy\"\nopen = { max = \"a[0] - a[2]\" }\n";
    workshop.write("plan.toml", plan);
    alike(&workshop);
    // Without leave the rows are refused, for the same reason.
    workshop.write("plan.toml", plan.replace("redundant = \"least-norm\"\n", ""));
    for (name, options) in [("c.csv", &[][..]), ("i.csv", &["--interpret"])] {
        let Outcome { stderr, .. } = workshop.mbs(&[&["sweep", "plan.toml", "--out", name], options].concat());
        assert!(stderr.contains("2 members of 2 stopped; the first is 0: "), "{stderr}");
    }
    assert!(workshop.read("c.csv") == workshop.read("i.csv"));
}

/// What one engine has begun the other goes on with.
#[test]
fn engines_share_a_table() {
    if !has_compiler("engines share a table") {
        return;
    }
    let workshop = Workshop::new();
    workshop.write("cart.mbs", CART);
    workshop.write("push.csv", "0,3\n2,0\n");
    workshop.write("plan.toml", PLAN.replace("until = { zero = \"x - far\", direction = \"rising\" }\n", ""));
    let whole = alike(&workshop);
    let half = |rank, options: &[&str]| {
        workshop.good(&[&["sweep", "plan.toml", "--rank", rank, "--ranks", "2"], options].concat())
    };
    assert!(half("0", &[]).contains(" by rank 0 of 2, by compiled code; "));
    assert!(half("1", &["--interpret"]).contains(" by rank 1 of 2, by the interpreter; "));
    workshop.good(&["sweep", "plan.toml", "--merge"]);
    assert!(workshop.read("plan.csv") == whole);
}

/// A compiler that is not there, or fails, is said, and members are interpreted.
#[test]
fn without_a_compiler_members_are_interpreted() {
    let workshop = Workshop::new();
    workshop.write("plan.toml", "mechanism = \"cart.mbs\"\n[fixed]\nm = 1\n[vary]\nx = { values = [0, 1] }\n[signals]\nshake = \"0\"\n[motion]\nduration = 1\n[quantities]\nlast = \"x\"\n");
    workshop.write("cart.mbs", CART);
    let (expected, _) = table(&workshop, "expected.csv", &["--interpret"]);
    let check = |name: &str, compiler: &str, warning: &str| {
        let arguments = ["sweep", "plan.toml", "--out", name, "--compiler", compiler];
        let Outcome { code, stdout, stderr } = workshop.mbs(&arguments);
        assert!(code == 0 && stdout.contains(" by the interpreter on "), "{stdout}{stderr}");
        assert!(stderr.starts_with(&format!("warning: {warning}")), "{stderr}");
        assert!(stderr.ends_with("; members are interpreted, which takes longer\n"), "{stderr}");
        assert!(workshop.read(name) == expected);
    };
    check("none.csv", "no-such-compiler", "there is no C compiler `no-such-compiler`");
    #[cfg(unix)]
    check("fails.csv", "false", "/");
    let both = workshop.mbs(&["sweep", "plan.toml", "--interpret", "--compiler", "cc"]);
    assert_eq!(both.code, 2);
}
