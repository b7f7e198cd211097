//! Memory does not grow with the number of members. A program of its own, so that nothing else is measured.

#![cfg(target_os = "linux")]

use std::time::Instant;

use mbs_ensemble::table::{Column, Format};
use mbs_ensemble::{Member, Plan, Share, Sweep, Variables, journal};

/// The most memory that this process has had \[kB\].
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

/// Makes a table; how long its members took, and the table itself \[s\].
fn run(members: u64) -> [f64; 2] {
    let text = format!("members = {members}\ndesign = \"latin-hypercube\"\n[vary]\nx = {{ normal = [0, 1] }}");
    let design = Plan::read(&text).unwrap().design(&Variables::new([("x", "1")])).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let sweep = Sweep {
        design: &design,
        quantities: ["a", "b", "c", "d"].map(|name| Column::new(name, "1")).to_vec(),
        table: folder.path().join("table.csv"),
        format: Format::Csv,
        identity: journal::Identity::new([("plan", journal::digest(text.as_bytes()))]),
    };
    let powers = |member: &Member| Ok((1..=4).map(|n| member.values[0].powi(n)).collect());
    let began = Instant::now();
    sweep.run(&powers, Share::WHOLE, 2, &|_| ()).unwrap();
    let ran = began.elapsed().as_secs_f64();
    assert_eq!(sweep.merge(|_| ()).unwrap().members, members);
    [ran, began.elapsed().as_secs_f64() - ran]
}

#[test]
fn memory_does_not_grow_with_the_number_of_members() {
    run(10_000);
    let before = peak();
    let [ran, merged] = run(200_000);
    let after = peak();
    println!("200 000 members: {ran:.2} s, their table: {merged:.2} s; {before} kB of memory before, {after} kB after");
    // All rows would be 8 MB. What a thread keeps to itself is 4096 members at most.
    assert!(after < before + 2_000, "{before} kB, then {after} kB");
}
