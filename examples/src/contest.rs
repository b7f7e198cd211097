//! Who is faster: functions that are timed in one process, in rounds in each of which everyone has a turn, so that what
//! disturbs the machine disturbs all alike.

use std::hint::black_box;
use std::time::Instant;

/// One function of one contender, and the seconds that a round of it takes.
pub struct Contender<'a> {
    /// What it is called in the table.
    pub name: &'static str,
    round: Box<dyn FnMut() -> f64 + 'a>,
}

impl<'a> Contender<'a> {
    /// A round is a call with each of these arguments.
    ///
    /// The loop over the arguments is compiled with the function in it, so that nothing but the function is timed.
    pub fn new<A, R>(name: &'static str, arguments: &'a [A], mut call: impl FnMut(&A) -> R + 'a) -> Self {
        let round = move || {
            let start = Instant::now();
            for argument in arguments {
                black_box(call(black_box(argument)));
            }
            start.elapsed().as_secs_f64()
        };
        Self { name, round: Box::new(round) }
    }
}

/// The names of the contenders, and the median of the times of their rounds \[s\].
pub fn medians(mut contenders: Vec<Contender<'_>>, rounds: usize) -> Vec<(&'static str, f64)> {
    let mut seconds = vec![Vec::with_capacity(rounds); contenders.len()];
    for _ in 0..rounds {
        for (contender, seconds) in contenders.iter_mut().zip(&mut seconds) {
            seconds.push((contender.round)());
        }
    }
    let median = |(contender, mut seconds): (&Contender<'_>, Vec<f64>)| {
        seconds.sort_by(f64::total_cmp);
        (contender.name, seconds[rounds / 2])
    };
    contenders.iter().zip(seconds).map(median).collect()
}

/// With one decimal.
#[must_use]
pub fn tenths(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everyone_has_a_turn_in_each_round() {
        let turns = std::cell::RefCell::new(String::new());
        let slow = Contender::new("slow", &["a", "b"], |letter| {
            turns.borrow_mut().push_str(letter);
            std::thread::sleep(std::time::Duration::from_millis(2));
        });
        let quick = Contender::new("quick", &["c"], |letter| turns.borrow_mut().push_str(letter));
        let found = medians(vec![slow, quick], 3);
        assert_eq!(*turns.borrow(), "abcabcabc");
        assert!(matches!(found[..], [("slow", slow), ("quick", quick)] if slow >= 4e-3 && quick < slow), "{found:?}");
    }
}
