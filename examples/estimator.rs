//! draft

#[path = "estimator/monte_carlo.rs"]
mod monte_carlo;

use mbs_examples::Failure;
use mbs_landing::estimator::chi_square::{NORMAL_95, bounds_of_mean};
use mbs_landing::quadrotor::heave::Heave;

fn main() -> Result<(), Failure> {
    let start = std::time::Instant::now();
    for heave in [Heave::CASE_I] {
        let runs = monte_carlo::runs(heave, 500)?;
        println!("{:?}", start.elapsed());
        let looks = runs.iter().map(|r| r.state.len()).min().unwrap();
        let n = runs.len() as f64;
        println!("{:?}", bounds_of_mean(NORMAL_95, 15.0, n));
        for k in 0..looks {
            let nees: f64 = runs.iter().map(|r| r.state[k]).sum::<f64>() / n;
            let range: Vec<f64> = runs.iter().filter_map(|r| r.range[k]).map(|i| i.squared).collect();
            let image: Vec<(f64, f64)> =
                runs.iter().filter_map(|r| r.image[k]).map(|i| (i.squared, i.freedom as f64)).collect();
            let dof: f64 = image.iter().map(|x| x.1).sum();
            println!(
                "{k} {nees:.3}  {:.3} ({})  {:.3} ({dof}, +- {:.3})",
                range.iter().sum::<f64>() / range.len() as f64,
                range.len(),
                image.iter().map(|x| x.0).sum::<f64>() / dof,
                1.96 * (2.0 / dof).sqrt()
            );
        }
        let mut sq = nalgebra::SVector::<f64, 15>::zeros();
        let mut l = 0;
        for r in &runs {
            sq += r.squares;
            l += r.state.len();
        }
        println!("{:.3}", (sq / l as f64).transpose());
        println!(
            "refused {} of {}",
            runs.iter().map(|r| r.refused).sum::<usize>(),
            runs.iter().map(|r| r.measured).sum::<usize>()
        );
        for f in [|r: &monte_carlo::Run| r.estimated, |r: &monte_carlo::Run| r.exact] {
            let off: Vec<f64> = runs.iter().map(|r| f(r).horizontal_offset).collect();
            let v: Vec<f64> = runs.iter().map(|r| f(r).relative_velocity).collect();
            let t: Vec<f64> = runs.iter().map(|r| f(r).time).collect();
            let m = |x: &[f64]| {
                let a = x.iter().sum::<f64>() / n;
                (
                    a,
                    (x.iter().map(|y| (y - a).powi(2)).sum::<f64>() / (n - 1.0)).sqrt(),
                    x.iter().fold(0.0_f64, |a, b| a.max(b.abs())),
                )
            };
            println!("{:?} {:?} {:?}", m(&off), m(&v), m(&t));
        }
    }
    Ok(())
}
