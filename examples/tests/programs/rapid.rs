//! RAPID modules of `arm_trajectory`, read back by a reader of our own: what they say, where the arm goes, and which
//! axes leave their ranges; texts that are no such modules.

use std::path::Path;

use nalgebra::{Rotation3, Vector3};

use crate::rapid_reader::{Module, Refused, read};
use crate::support::{good, run};

const TRAJECTORY: &str = env!("CARGO_BIN_EXE_arm_trajectory");

/// The robot's own ranges \[°\] and speeds \[°/s\], as `docs/thesis/assumed.md` recalls them.
const RANGES: [[f64; 2]; 6] =
    [[-180.0, 180.0], [-60.0, 85.0], [-180.0, 60.0], [-300.0, 300.0], [-100.0, 100.0], [-300.0, 300.0]];
const SPEEDS: [f64; 6] = [75.0, 50.0, 55.0, 100.0, 100.0, 160.0];

fn written(folder: &Path, name: &str) -> Module {
    let text = std::fs::read_to_string(folder.join(name)).unwrap();
    assert!(text.is_ascii(), "{name}");
    read(&text).unwrap_or_else(|refused| panic!("{name}: {refused:?}"))
}

/// Axes, counted from 1, that leave their ranges, and the angle farthest outside.
fn outside(module: &Module) -> Vec<(usize, f64)> {
    let excess = |axis: usize, angle: f64| (RANGES[axis][0] - angle).max(angle - RANGES[axis][1]);
    (0..6)
        .filter_map(|axis| {
            let angles = module.moves.iter().map(|step| step.angles[axis]);
            let worst = angles.max_by(|a, b| excess(axis, *a).total_cmp(&excess(axis, *b)))?;
            (excess(axis, worst) > 0.0).then_some((axis + 1, worst))
        })
        .collect()
}

/// `q₀ + v₀ t + b s³ + c s⁴` with s = t/T: no acceleration at first, at rest at the end.
fn quartic(start: f64, stop: f64, speed: f64, t: f64) -> f64 {
    let (s, way, slope) = (t / 50.0, stop - start - 50.0 * speed, -50.0 * speed);
    start + speed * t + (4.0 * way - slope) * s.powi(3) + (slope - 3.0 * way) * s.powi(4)
}

#[test]
fn the_printed_motion_leaves_the_ranges_and_the_variant_keeps_them() {
    let folder = tempfile::tempdir().unwrap();
    good(TRAJECTORY, &["--out", folder.path().to_str().unwrap()]);
    let printed = ([20.0, 10.0 + 90.0, 10.0, 10.0, 20.0, 10.0], [50.0, 90.0 + 90.0, 120.0, 80.0, 60.0, 100.0]);
    let variant = ([20.0, 10.0, 10.0, 10.0, 20.0, 10.0], [50.0, 80.0, 55.0, 80.0, 60.0, 100.0]);
    for (case, speed) in [(1, 0.0), (2, 1.5)] {
        for (suffix, module_name, (start, stop)) in [("", "", printed), ("_in_range", "InRange", variant)] {
            let module = written(folder.path(), &format!("case{case}{suffix}.mod"));
            assert_eq!(module.name, format!("Case{case}{module_name}"));
            assert_eq!(module.moves.len(), 51);
            for (k, step) in module.moves.iter().enumerate() {
                assert_eq!(step.time, (k > 0).then_some(1.0));
                for axis in 0..6 {
                    let want = quartic(start[axis], stop[axis], speed, k as f64);
                    // Six decimals.
                    assert!((step.angles[axis] - want).abs() < 5.1e-7, "case {case}{suffix}, {k}: {step:?}");
                }
            }
            for pair in module.moves.windows(2) {
                assert!((0..6).all(|axis| (pair[1].angles[axis] - pair[0].angles[axis]).abs() < SPEEDS[axis]));
            }
            let expected = if suffix.is_empty() { vec![(2, 180.0), (3, 120.0)] } else { Vec::new() };
            assert_eq!(outside(&module), expected, "case {case}{suffix}");
        }
    }
}

/// A module that cannot be written is named, and nothing is left of it.
#[test]
fn a_module_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("case1.mod")).unwrap();
    let output = run(TRAJECTORY, &["--out", folder.path().to_str().unwrap()]);
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && told.contains("case1.mod: "), "{told}");
    assert!(!folder.path().join("case1.part").exists());
}

/// The flange from the robot's own angles: upright at zero with the forearm forwards, axes 1, 4, 6 along z, x, x and 2,
/// 3, 5 along y; against the flange of Denavit and Hartenberg's angles in the tables.
#[test]
fn own_angles_bring_the_flange_where_those_of_denavit_and_hartenberg_do() {
    let folder = tempfile::tempdir().unwrap();
    good(TRAJECTORY, &["--out", folder.path().to_str().unwrap()]);
    for case in ["case1", "case2"] {
        let module = written(folder.path(), &format!("{case}.mod"));
        let table = std::fs::read_to_string(folder.path().join(format!("{case}_quartic.csv"))).unwrap();
        let rows: Vec<Vec<f64>> =
            table.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
        for (k, step) in module.moves.iter().enumerate() {
            let angle = |axis: usize| step.angles[axis].to_radians();
            let about = |axis: usize, direction| Rotation3::from_axis_angle(&direction, angle(axis));
            let (x, y, z) = (Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis());
            let hand = about(3, x) * (Vector3::new(1.056, 0.0, 0.0) + about(4, y) * Vector3::new(0.25, 0.0, 0.0));
            let forearm = about(2, y) * (Vector3::new(0.0, 0.0, 0.165) + hand);
            let arm = about(1, y) * (Vector3::new(0.0, 0.0, 1.075) + forearm);
            let flange = about(0, z) * (Vector3::new(0.41, 0.0, 0.78) + arm);
            let row = &rows[10 * k];
            assert!((row[0] - k as f64).abs() < 1e-12);
            // 5e-7° at 2.5 m
            assert!((0..3).all(|i| (flange[i] - row[25 + i]).abs() < 1e-7), "{case}, {k} s: {flange} {row:?}");
        }
    }
}

const GOOD: &str = "\
MODULE A
  CONST jointtarget j0:=[[1,-2,3,4,5,6],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
  CONST speeddata slow:=[100,30,100,30];
  CONST zonedata wide:=[FALSE,10,15,15,1.5,15,1.5];
  ! a word
  PROC main()
    MoveAbsJ j0,slow\\T:=2,wide,tool0;
    MoveAbsJ j0,v100,fine,tool0;
  ENDPROC
ENDMODULE
";

#[test]
fn what_is_no_module_is_refused_with_its_place() {
    let module = read(GOOD).unwrap();
    assert_eq!((module.moves[0].angles, module.moves[0].time), ([1.0, -2.0, 3.0, 4.0, 5.0, 6.0], Some(2.0)));
    assert_eq!(module.moves[1].time, None);
    let long = "a".repeat(33);
    let (named, complaint) = (format!("{long}:="), format!("the name '{long}' has more than 32 characters"));
    for (from, to, line, column, reason) in [
        ("[1,-2,3,4,5,6]", "[1,-2,3,4,5]", 2, 37, "expected ,, found ']'"),
        ("[1,-2,3,4,5,6]", "[1,-2,3,4,5,6,7]", 2, 39, "expected ], found ','"),
        ("[1,-2", "[1,x", 2, 29, "'x' is not a number"),
        ("100,30,100,30", "100,30,100", 3, 36, "expected ,, found ']'"),
        ("speeddata slow", "speeddata J0", 3, 19, "the name 'J0' is taken"),
        ("speeddata", "robtarget", 3, 9, "the type 'robtarget' is not read"),
        ("slow:=", named.as_str(), 3, 19, complaint.as_str()),
        ("MoveAbsJ j0,v100", "MoveAbsJ j1,v100", 8, 14, "'j1' is no jointtarget"),
        ("j0,v100", "j0,v101", 8, 17, "'v101' is no speeddata"),
        ("fine", "z3", 8, 22, "'z3' is no zonedata"),
        ("\\T:=2", "\\T:=0", 7, 25, "a move takes a time that is positive"),
        ("MoveAbsJ j0,v100", "MoveL j0,v100", 8, 5, "expected MoveAbsJ, found 'MoveL'"),
        ("fine,tool0", "fine", 8, 26, "expected ,, found ';'"),
        ("main", "other", 11, 1, "there is no PROC main()"),
        ("ENDMODULE", "", 11, 1, "expected PROC, found ''"),
        ("main()", "main() %", 6, 15, "the character '%' has no place here"),
    ] {
        let text = GOOD.replacen(from, to, 1);
        assert_ne!(text, GOOD, "{from}");
        let refused = Refused { line, column, reason: reason.to_string() };
        assert_eq!(read(&text).unwrap_err(), refused, "{from} -> {to}");
    }
}
