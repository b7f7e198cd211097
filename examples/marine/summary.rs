//! What is said of the platform, as text and as JSON.

use mbs_examples::Failure;
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_platform::marine::control::linearized;
use mbs_platform::marine::statistics::Statistics;
use mbs_runtime::control::{Complex, damping_ratio, natural_frequency};
use serde_json::{Value, json};

use crate::run::{PERIOD, Run, Study};

pub(crate) const COORDINATES: [(&str, &str); 4] = [("heave", "m"), ("roll", "°"), ("pitch", "°"), ("yaw", "°")];
const THRUSTERS: [&str; 6] =
    ["lift ahead left", "lift ahead right", "lift behind left", "lift behind right", "lateral ahead", "lateral behind"];

/// From SI to what is printed.
fn in_unit(i: usize, value: f64) -> f64 {
    if i == 0 { value } else { value.to_degrees() }
}

/// Of the thrust of one thruster in a run.
struct Use {
    greatest: f64,
    rms: f64,
    /// The part of the time in which it did not do what was asked.
    limited: f64,
}

fn use_of(run: &Run, i: usize) -> Use {
    let count = run.moments.len() as f64;
    let thrusts = || run.moments.iter().map(|moment| moment.thrust[i]);
    Use {
        greatest: thrusts().fold(0.0, |most, thrust| most.max(thrust.abs())),
        rms: (thrusts().map(|thrust| thrust * thrust).sum::<f64>() / count).sqrt(),
        limited: run.moments.iter().filter(|moment| moment.thrust[i] != moment.asked[i]).count() as f64 / count,
    }
}

fn statistics(run: &Run) -> [Statistics; 4] {
    std::array::from_fn(|i| Statistics::of(&run.coordinate(i)))
}

/// Those of the free platform and of the loop.
fn poles(study: &Study) -> Result<[[Complex; 8]; 2], Failure> {
    let plant = linearized(&study.hull.params);
    Ok([plant.poles()?, plant.with_feedback(&study.regulator.gain).poles()?])
}

pub(crate) fn to_json(study: &Study) -> Result<Value, Failure> {
    let (spectrum, hull) = (&study.spectrum, &study.hull);
    let record = Statistics::of(&study.elevation());
    let [free, closed] = poles(study)?;
    let pairs = |poles: [Complex; 8]| poles.map(|pole| [pole.re, pole.im]);
    let named = |values: [f64; 4]| -> Value {
        COORDINATES.iter().zip(values).map(|((name, _), value)| (name.to_string(), json!(value))).collect()
    };
    let [before, after] = [0, 1].map(|run| statistics(&study.runs[run]));
    Ok(json!({
        "sea": {
            "significant_wave_height": spectrum.height(),
            "peak_period": spectrum.period(),
            "peakedness": spectrum.peakedness(),
            "variance": spectrum.variance(),
            "variance_of_the_waves": study.sea.moment(0),
            "zero_crossing_period": spectrum.zero_crossing_period(),
            "record": {
                "variance": record.rms * record.rms,
                "significant_wave_height": record.significant_double_amplitude(),
                "zero_crossing_period": record.crossing * PERIOD,
                "greatest_elevation": record.greatest,
            },
        },
        "wind": {
            "mean": study.wind.mean,
            "gusts_rms": study.wind.amplitude * (0.5 * study.wind.gusts.len() as f64).sqrt(),
        },
        "platform": {
            "displacement": hull.displacement,
            "draught_of_the_columns": hull.draught,
            "metacentric_heights": hull.metacentric_heights,
            "natural_periods": named(hull.natural_periods()),
        },
        "poles": { "uncontrolled": pairs(free), "controlled": pairs(closed) },
        "uncontrolled": of_run(&study.runs[0]),
        "controlled": of_run(&study.runs[1]),
        "rms_ratio": named(std::array::from_fn(|i| after[i].rms / before[i].rms)),
        "thrusters": thrusters(study),
    }))
}

fn of_run(run: &Run) -> Value {
    let mut all = json!({});
    for (i, (name, _)) in COORDINATES.iter().enumerate() {
        let of = Statistics::of(&run.coordinate(i));
        let rate = Statistics::of(&run.moments.iter().map(|moment| moment.qd[i]).collect::<Vec<_>>());
        all[*name] = json!({
            "mean": of.mean,
            "rms": of.rms,
            "significant_double_amplitude": of.significant_double_amplitude(),
            "greatest": of.greatest,
            "rate_rms": rate.rms,
        });
    }
    all["least_air_gap"] = json!(run.least_air_gap);
    all["least_column_depth"] = json!(run.least_depth);
    all["touchdown"] = of_landing(&run.landings[0]);
    all["touchdowns"] = run.landings.iter().map(of_landing).collect();
    all
}

fn of_landing(end: &Touchdown) -> Value {
    json!({
        "time": end.time,
        "relative_velocity": end.relative_velocity,
        "horizontal_offset": end.horizontal_offset,
        "horizontal_speed": end.horizontal_speed,
        "tilt_against_deck": tilt(end),
        "deck_height": end.deck.position[2],
        "deck_vertical_velocity": end.deck.velocity[2],
    })
}

/// Angle between the vehicle's axis and the deck's normal \[rad\].
fn tilt(end: &Touchdown) -> f64 {
    let [roll, pitch, _] = end.relative.attitude;
    (roll.cos() * pitch.cos()).acos()
}

fn thrusters(study: &Study) -> Value {
    let row = |i: usize| {
        let Use { greatest, rms, limited } = use_of(&study.runs[1], i);
        let limit = study.limits.thrust[i];
        let value = json!({ "limit": limit, "greatest": greatest, "rms": rms, "limited": limited });
        (THRUSTERS[i].to_string(), value)
    };
    (0..6).map(row).collect()
}

pub(crate) fn text(study: &Study) -> Result<String, Failure> {
    let (spectrum, hull) = (&study.spectrum, &study.hull);
    let record = Statistics::of(&study.elevation());
    let [transverse, longitudinal] = hull.metacentric_heights;
    let mut text = format!(
        "sea of Hs = {} m, Tp = {} s, γ = {}; Tz = {:.2} s; in the record Hs = {:.2} m, Tz = {:.2} s\n\
         wind of {} m/s\n\
         platform of {:.0} m³, columns {:.2} m deep, GM = {transverse:.2} m in roll, {longitudinal:.2} m in pitch\n\n",
        spectrum.height(),
        spectrum.period(),
        spectrum.peakedness(),
        spectrum.zero_crossing_period(),
        record.significant_double_amplitude(),
        record.crossing * PERIOD,
        study.wind.mean,
        hull.displacement,
        hull.draught,
    );
    text += "               natural       mean        root mean square    significant double amplitude   greatest deviation\n";
    text += "             period [s]   without   with    without     with        without     with          without     with\n";
    let periods = hull.natural_periods();
    let [before, after] = [0, 1].map(|run| statistics(&study.runs[run]));
    for (i, (name, unit)) in COORDINATES.iter().enumerate() {
        let of: [fn(&Statistics) -> f64; 4] =
            [|s| s.mean, |s| s.rms, Statistics::significant_double_amplitude, |s| s.greatest];
        let cells = of.into_iter().flat_map(|of| [of(&before[i]), of(&after[i])]).map(|value| in_unit(i, value));
        let label = format!("{name} [{unit}]");
        text += &format!("{label:<12} {:>9.2} ", periods[i]);
        for (cell, width) in cells.zip([9, 8, 9, 9, 14, 9, 14, 9]) {
            text += &format!(" {cell:>width$.3}");
        }
        text += "\n";
    }
    text += "\nthruster               limit [kN]   greatest   root mean square   held back\n";
    for (i, name) in THRUSTERS.iter().enumerate() {
        let Use { greatest, rms, limited } = use_of(&study.runs[1], i);
        let [limit, greatest, rms] = [study.limits.thrust[i], greatest, rms].map(|newton| newton / 1e3);
        text += &format!("{name:<20} {limit:>12.1} {greatest:>10.1} {rms:>18.1} {:>9.1} %\n", 100.0 * limited);
    }
    let slowest = |poles: [Complex; 8]| {
        let mut damping = poles.map(|pole| (natural_frequency(pole), damping_ratio(pole)));
        damping.sort_by(|a, b| a.1.total_cmp(&b.1));
        damping[0]
    };
    let [free, closed] = poles(study)?.map(slowest);
    text += &format!(
        "least damped pole: {:.1} % at {:.3} rad/s without, {:.1} % at {:.3} rad/s with control\n\n",
        100.0 * free.1,
        free.0,
        100.0 * closed.1,
        closed.0
    );
    text += "landings        first touchdown [s]   all [s]            deck's vertical speed then, at most [m/s]   beside the point, at most [m]   tilt against the deck, at most [°]   air gap [m]\n";
    for run in &study.runs {
        let most = |of: fn(&Touchdown) -> f64| run.landings.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        text += &format!(
            "{:<14} {:>20.3}   {:.3} to {:.3} {:>39.3} {:>31.4} {:>35.2} {:>13.2}\n",
            run.name,
            run.landings[0].time,
            -most(|end| -end.time),
            most(|end| end.time),
            most(|end| end.deck.velocity[2].abs()),
            most(|end| end.horizontal_offset),
            most(tilt).to_degrees(),
            run.least_air_gap
        );
    }
    Ok(text)
}
