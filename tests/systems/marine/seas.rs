//! Spectra, seas and gusts against closed forms and against records of them.

use mbs_platform::marine::sea::{Sea, Spreading};
use mbs_platform::marine::spectrum::Jonswap;
use mbs_platform::marine::wind::{FASTEST, SURFACE_DRAG, Wind};
use std::f64::consts::PI;

use super::{sea, uniform};

fn jonswap(peakedness: f64) -> Jonswap {
    Jonswap::new(2.5, 10.0, peakedness).expect("a sea")
}

/// `∫ f` from a to b, by Simpson's rule.
fn integral(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (pieces, h) = (20_000, (b - a) / 20_000.0);
    let piece = |k: i32| {
        let x = a + h * f64::from(k);
        f(x) + 4.0 * f(x + 0.5 * h) + f(x + h)
    };
    h / 6.0 * (0..pieces).map(piece).sum::<f64>()
}

#[test]
fn the_spectrum_is_that_of_the_project() {
    let (height, peak) = (2.5_f64, 2.0 * PI / 10.0);
    for w in [0.4, 0.6, peak, 0.7, 1.0, 2.0, 5.0] {
        let ratio: f64 = peak / w;
        let base = 5.0 / 16.0 * height.powi(2) * peak.powi(4) / w.powi(5) * (-1.25 * ratio.powi(4)).exp();
        // Pierson and Moskowitz, where nothing is raised.
        assert!((jonswap(1.0).density(w) / base - 1.0).abs() < 1e-9, "{w}");
        // The usual approximation of the factor, DNV-RP-C205, section 3.5.5.
        let width: f64 = if w <= peak { 0.07 } else { 0.09 };
        let r = (-0.5 * ((w / peak - 1.0) / width).powi(2)).exp();
        let raised = (1.0 - 0.287 * 3.3_f64.ln()) * base * 3.3_f64.powf(r);
        assert!((jonswap(3.3).density(w) / raised - 1.0).abs() < 0.01, "{w}: {}", jonswap(3.3).density(w) / raised);
    }
    for peakedness in [1.0, 3.3, 7.0] {
        let spectrum = jonswap(peakedness);
        let area = integral(0.1, peak, |w| spectrum.density(w)) + integral(peak, 60.0, |w| spectrum.density(w));
        // Beyond 60 rad/s there are 1e-9 of it.
        assert!((area / (height * height / 16.0) - 1.0).abs() < 1e-7, "{peakedness}: {area}");
    }
    assert_eq!((jonswap(3.3).density(0.0), jonswap(3.3).density(-1.0)), (0.0, 0.0));
}

#[test]
fn the_zero_crossing_period_is_known() {
    // ∫ x⁻⁵ exp(−5/4 x⁻⁴) = 1/5, ∫ x⁻³ exp(−5/4 x⁻⁴) = ¼ √(4π/5).
    let moskowitz = 10.0 * (0.2 / (0.25 * (0.8 * PI).sqrt())).sqrt();
    assert!((jonswap(1.0).zero_crossing_period() - moskowitz).abs() < 1e-8);
    // DNV-RP-C205, section 3.5.5.
    for y in [1.0, 2.0, 3.3, 5.0, 7.0_f64] {
        let ratio = 0.6673 + 0.05037 * y - 0.006230 * y * y + 0.0003341 * y * y * y;
        assert!((jonswap(y).zero_crossing_period() / 10.0 - ratio).abs() < 2e-3, "{y}");
    }
}

fn check_energy<const N: usize>() {
    for (height, period) in [(2.5, 10.0), (0.01, 1.0), (9.0, 16.0)] {
        let spectrum = Jonswap::new(height, period, 3.3).expect("a sea");
        let sea = Sea::<N>::new(&spectrum, 0.0, Spreading::None, uniform(5)).expect("its waves");
        assert!((sea.moment(0) / (height * height / 16.0) - 1.0).abs() < 1e-12);
    }
}

/// Σ ½ A² is Hs²/16, and each component is out of its part of the energy.
#[test]
fn waves_have_the_energy_of_the_spectrum() {
    check_energy::<1>();
    check_energy::<7>();
    check_energy::<240>();
    let (sea, spectrum) = (sea::<100>(3), jonswap(3.3));
    let total = integral(0.2, 5.0 * spectrum.peak(), |w| spectrum.density(w));
    for (n, wave) in sea.waves.iter().enumerate() {
        let part = 100.0 * integral(0.2, wave.frequency, |w| spectrum.density(w)) / total;
        assert!((n as f64 - 1e-3..n as f64 + 1.001).contains(&part), "wave {n}: {part}");
    }
}

/// Three hours: variance, zero crossings, and the fourth moment of a normal process.
#[test]
fn a_record_has_the_statistics_of_the_spectrum() {
    let sea = sea::<240>(11);
    let values: Vec<f64> = (0..43_200).map(|k| sea.elevation([3.0, -2.0], 0.25 * f64::from(k))).collect();
    let moment = |n: i32| values.iter().map(|z| z.powi(n)).sum::<f64>() / values.len() as f64;
    let variance = 2.5_f64.powi(2) / 16.0;
    assert!(moment(1).abs() < 0.01 && (moment(2) / variance - 1.0).abs() < 0.05, "{} {}", moment(1), moment(2));
    let kurtosis = moment(4) / moment(2).powi(2);
    assert!((kurtosis - 3.0).abs() < 0.3, "{kurtosis}");
    let upward = values.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
    let found = 10_800.0 / upward as f64;
    let expected = 2.0 * PI * (sea.moment(0) / sea.moment(2)).sqrt();
    assert!((found / expected - 1.0).abs() < 0.03, "{found} s, {expected} s");
    // Waves shorter than a fifth of the peak's period are left out.
    assert!((expected / jonswap(3.3).zero_crossing_period() - 1.0).abs() < 0.05, "{expected} s");
}

/// The correlation of the record with itself some time later, by the components.
#[test]
fn a_record_does_not_repeat() {
    let sea = sea::<240>(11);
    let correlation = |lag: f64| sea.waves.iter().map(|wave| (wave.frequency * lag).cos()).sum::<f64>() / 240.0;
    let most = (100..36_000).map(|lag| correlation(f64::from(lag)).abs()).fold(0.0, f64::max);
    assert!(most < 0.5, "{most}");
}

#[test]
fn crests_are_as_long_as_asked_for() {
    let spectrum = jonswap(3.3);
    let spread = Sea::<400>::new(&spectrum, 0.7, Spreading::CosineSquared, uniform(2)).expect("waves");
    let mean = |f: fn(f64) -> f64| spread.waves.iter().map(|wave| f(wave.direction - 0.7)).sum::<f64>() / 400.0;
    // 2/π ∫ cos² χ cos 2χ = ½, ∫ cos² χ sin χ = 0; standard errors 0.025 and 0.027.
    assert!((mean(|x| (2.0 * x).cos()) - 0.5).abs() < 0.08, "{}", mean(|x| (2.0 * x).cos()));
    assert!(mean(f64::sin).abs() < 0.09, "{}", mean(f64::sin));
    assert!(spread.waves.iter().all(|wave| (wave.direction - 0.7).abs() <= 0.5 * PI));
    let long = Sea::<5>::new(&spectrum, 0.7, Spreading::None, uniform(2)).expect("waves");
    assert!(long.waves.iter().all(|wave| wave.direction == 0.7));
}

#[test]
fn a_seed_is_a_sea() {
    assert_eq!(sea::<50>(1), sea::<50>(1));
    assert_ne!(sea::<50>(1), sea::<50>(2));
    assert_eq!(Wind::<9>::new(8.0, 0.0, uniform(1)), Wind::<9>::new(8.0, 0.0, uniform(1)));
    assert_ne!(Wind::<9>::new(8.0, 0.0, uniform(1)), Wind::<9>::new(8.0, 0.0, uniform(2)));
}

/// `f S(f) = 4 κ U² χ²/(1 + χ²)^(4/3)`, integrated over ln f.
#[test]
fn gusts_have_davenports_spectrum() {
    let mean = 12.0;
    let wind = Wind::<50>::new(mean, 0.0, uniform(4)).expect("a wind");
    let density = |log: f64| {
        let chi = 1200.0 * log.exp() / mean;
        4.0 * SURFACE_DRAG * mean * mean * chi * chi / (1.0 + chi * chi).powf(4.0 / 3.0)
    };
    let below = |frequency: f64| integral(-30.0, frequency.ln(), density);
    let variance = 0.5 * wind.amplitude.powi(2) * 50.0;
    assert!((variance / below(FASTEST) - 1.0).abs() < 1e-6, "{variance}");
    assert!(variance < 6.0 * SURFACE_DRAG * mean * mean);
    for (n, [frequency, _]) in wind.gusts.iter().enumerate() {
        let part = 50.0 * below(frequency / (2.0 * PI)) / variance;
        assert!((n as f64 - 1e-3..n as f64 + 1.001).contains(&part), "gust {n}: {part}");
    }
    let values: Vec<f64> = (0..40_000).map(|k| wind.speed(0.5 * f64::from(k))).collect();
    let average = values.iter().sum::<f64>() / 4e4;
    let found = values.iter().map(|v| (v - average).powi(2)).sum::<f64>() / 4e4;
    assert!((average - mean).abs() < 0.1 && (found / variance - 1.0).abs() < 0.1, "{average} {found} {variance}");
}
