//! What an ensemble costs beside its members.

use std::time::Instant;

use mbs_ensemble::statistics::quantile;
use mbs_ensemble::sweep::Motion;
use mbs_ensemble::{Share, Sweep};
use mbs_examples::{Failure, println};

/// Members a second on one thread: of the loop over the closures alone, and of the ensemble with its journal and table.
pub(crate) fn compare(land: &dyn Motion, sweep: &Sweep<'_>) -> Result<(), Failure> {
    let members = sweep.design.members();
    let mut rates = [Vec::new(), Vec::new()];
    for _ in 0..5 {
        let began = Instant::now();
        let mut sum = 0.0;
        for index in 0..members {
            sum += land.quantities(&sweep.design.member(index)).map_or(0.0, |row| row[0]);
        }
        rates[0].push(members as f64 / began.elapsed().as_secs_f64());
        if !sum.is_finite() {
            return Err(Failure::new("a touchdown time is not finite"));
        }
        let began = Instant::now();
        sweep.run(land, Share::WHOLE, 1, &|_| ())?;
        sweep.merge(|_| ())?;
        rates[1].push(members as f64 / began.elapsed().as_secs_f64());
        std::fs::remove_file(&sweep.table)?;
    }
    let [bare, ensemble] = rates.map(|mut rates| {
        rates.sort_by(f64::total_cmp);
        quantile(&rates, 0.5)
    });
    println!("{bare:.1} members/s in the bare loop, {ensemble:.1} in the ensemble: {:.3}", ensemble / bare);
    Ok(())
}
