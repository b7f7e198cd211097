//! Landing times as maps, as an outside program calls them.

use std::process::Command;

use crate::support::{figure, good, json, keys, numbers, refused};
use mbs_landing::quadrotor::approach::Approach;
use mbs_landing::quadrotor::deck::MovingDeck;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_platform::Motion;

const MAPS: &str = env!("CARGO_BIN_EXE_landing_maps");

/// Cells against landings on a platform that moves so, by tighter tolerances; and where the deck falls too fast there
/// is no time.
#[test]
fn cells_are_landings_or_say_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(MAPS, &["--json", "--cells", "4", "--out", folder.path().to_str().unwrap()]));
    assert_eq!(keys(&found), ["amplitudes", "frequencies", "phases_deg", "limit", "maps", "assumed"]);
    let laws = ["exact_backstepping", "small_angle_backstepping", "exact_lqr", "small_angle_lqr"];
    assert_eq!(keys(&found["maps"]), laws);
    let [amplitudes, frequencies] = ["amplitudes", "frequencies"].map(|key| numbers(&found[key]));
    assert_eq!((&amplitudes[..], &frequencies[..]), (&[0.25, 0.75, 1.25, 1.75][..], &[0.5, 1.5, 2.5, 3.5][..]));
    for (law, plant) in laws.into_iter().zip([Plant::Exact, Plant::SmallAngle, Plant::Exact, Plant::SmallAngle]) {
        let map = &found["maps"][law];
        let mut lands = 0;
        for phase in [0.0_f64, 90.0, 180.0, 270.0] {
            for (i, w) in frequencies.iter().enumerate() {
                for (j, a) in amplitudes.iter().enumerate() {
                    let cell = &map["touchdown_time"][format!("{phase}")][i][j];
                    if a * w * w > 9.80665 {
                        assert_eq!(cell, "deck falls faster than g", "{law} {a} {w}");
                        continue;
                    }
                    let time = cell.as_f64().unwrap_or_else(|| panic!("{law} {a} {w}: {cell}"));
                    lands += 1;
                    if !law.ends_with("backstepping") || (i + j) % 3 != 0 {
                        continue;
                    }
                    let (sin, cos) = phase.to_radians().sin_cos();
                    let heave = |z: f64| [0.0, 0.0, z, 0.0, 0.0, 0.0];
                    let motion =
                        Motion { mean: [0.0; 6], sine: heave(a * cos), cosine: heave(a * sin), frequency: [*w; 6] };
                    let mut landing =
                        Landing::on(plant, MovingDeck { motion, base: [12.0, 7.0, 0.0], point: [0.0; 3] });
                    (landing.approach, landing.touchdown_height) = (Approach::UNGUIDED, 0.01);
                    let expected = landing.simulate(Landing::initial_state(), |_, _, _| ()).unwrap().time;
                    assert!((time - expected).abs() < 1e-4, "{law} {a} {w} {phase}: {time}, not {expected}");
                }
            }
        }
        assert_eq!(numbers(&map["lands"])[0] as i32, lands);
        assert_eq!(numbers(&map["no_landing"])[0] as i32, 64 - lands);
        let name = format!("landing_time_{law}");
        figure(folder.path(), &name);
        assert!(folder.path().join(name + ".csv").metadata().unwrap().len() > 500);
    }
}

#[test]
fn maps_do_not_depend_on_the_number_of_threads() {
    let with = |threads: &str| {
        let arguments = ["--json", "--cells", "3"];
        Command::new(MAPS).args(arguments).env("RAYON_NUM_THREADS", threads).output().unwrap().stdout
    };
    let one = with("1");
    assert!(one.len() > 1000 && one == with("3"));
    refused(MAPS, &["--cells", "1"]);
}
