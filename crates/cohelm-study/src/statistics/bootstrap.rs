//! Bootstrap intervals: what would the number have been with other participants of the same kind?
//!
//! Deterministic: the same data, options and version give the same interval on every machine.

use super::describe::{Interval, interquartile_mean, mean_of, quantile_of};
use super::distribution::normal_quantile;
use super::paired::effect_sizes;
use super::special::normal_cdf;
use super::{Paired, Undefined, require};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

/// How an interval is drawn up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Options {
    /// Number of resamples. 10 000 fixes the ends to about 1 % of the interval's width; below 1 000 they are noise.
    pub resamples: usize,
    /// Coverage, usually 0.95.
    pub level: f64,
    /// Seed of the generator (PCG64).
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Options { resamples: 10_000, level: 0.95, seed: 0 }
    }
}

/// A number with its bootstrap interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bootstrapped {
    /// The number in the data themselves.
    pub estimate: f64,
    /// Its interval.
    pub interval: Interval,
    /// How the interval was taken from the resamples.
    pub method: Method,
    /// Resamples in which the number was defined (a resample of one participant alone has no spread, say).
    pub defined_resamples: usize,
}

/// How an interval is taken from the resamples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Quantiles of the resamples.
    Percentile,
    /// Quantiles corrected for bias and skew (BCa, Efron 1987), which with few participants cover better.
    BiasCorrected,
}

/// Interval of the mean of `first − second` over participants.
///
/// # Errors
/// Fewer than two participants, or options out of range.
pub fn mean_difference(pairs: &Paired, options: Options) -> Result<Bootstrapped, Undefined> {
    let differences = pairs.differences();
    bootstrap(&[differences.len()], |chosen| Some(mean_of(&pick(&differences, chosen))), options)
}

/// Interval of the standardised difference [`super::EffectSizes::d_av`].
///
/// # Errors
/// Fewer than two participants, no variation, or options out of range.
pub fn effect_size(pairs: &Paired, options: Options) -> Result<Bootstrapped, Undefined> {
    effect_sizes(pairs)?;
    let d_av = |chosen: &[usize]| {
        let resample = Paired::new(&pick(pairs.a(), chosen), &pick(pairs.b(), chosen)).ok()?;
        effect_sizes(&resample).ok().map(|e| e.d_av)
    };
    bootstrap(&[pairs.len()], d_av, options)
}

/// Interval of the interquartile mean over all values, drawn anew within each group (stratified, as Agarwal et al. 2021).
///
/// # Errors
/// An empty group, fewer than two values, or options out of range.
pub fn stratified_interquartile_mean(
    groups: &[Vec<f64>],
    options: Options,
) -> Result<Bootstrapped, Undefined> {
    let sizes: Vec<usize> = groups.iter().map(Vec::len).collect();
    let values = groups.concat();
    super::require_finite(&values)?;
    bootstrap(&sizes, |chosen| interquartile_mean(&pick(&values, chosen)).ok(), options)
}

/// Interval of any statistic of resampled units.
///
/// Units are numbered through all strata (those of the first, then those of the second, …) and drawn with replacement
/// within their stratum; `statistic` gets the numbers drawn and returns `None` where it is undefined. One stratum gets
/// the BCa interval, several the percentile interval.
///
/// # Errors
/// An empty stratum, fewer than two units, a statistic undefined in the data or in more than half of the resamples,
/// options out of range.
pub fn bootstrap(
    strata: &[usize],
    statistic: impl Fn(&[usize]) -> Option<f64>,
    options: Options,
) -> Result<Bootstrapped, Undefined> {
    check(strata, options)?;
    let everybody: Vec<usize> = (0..strata.iter().sum()).collect();
    let statistic = |chosen: &[usize]| statistic(chosen).filter(|v| v.is_finite());
    let estimate = statistic(&everybody).ok_or(Undefined::NoVariation)?;
    let resamples = resampled(strata, statistic, options);
    require(
        "a bootstrap interval",
        "resamples with a defined value",
        options.resamples / 2,
        resamples.len(),
    )?;
    let tail = (1.0 - options.level) / 2.0;
    let left_out = |unit: usize| everybody.iter().copied().filter(|&i| i != unit).collect::<Vec<_>>();
    let corrected = match strata {
        [_] => {
            let jackknife: Option<Vec<f64>> =
                everybody.iter().map(|&unit| statistic(&left_out(unit))).collect();
            jackknife.and_then(|jackknife| bias_corrected(estimate, &resamples, &jackknife, tail))
        }
        _ => None,
    };
    let (method, ends) = match corrected {
        Some(ends) => (Method::BiasCorrected, ends),
        None => (Method::Percentile, (tail, 1.0 - tail)),
    };
    let interval = Interval {
        low: quantile_of(&resamples, ends.0),
        high: quantile_of(&resamples, ends.1),
        level: options.level,
    };
    Ok(Bootstrapped { estimate, interval, method, defined_resamples: resamples.len() })
}

fn check(strata: &[usize], options: Options) -> Result<(), Undefined> {
    require("a bootstrap interval", "units", 2, strata.iter().sum())?;
    require("a bootstrap interval", "units in every stratum", 1, strata.iter().copied().min().unwrap_or(0))?;
    require("a bootstrap interval", "resamples", 2, options.resamples)?;
    if options.level > 0.0 && options.level < 1.0 {
        return Ok(());
    }
    Err(Undefined::OutOfRange {
        name: "the level",
        expected: "between 0 and 1",
        found: options.level.to_string(),
    })
}

/// The statistic of every resample where it is defined, sorted.
fn resampled(strata: &[usize], statistic: impl Fn(&[usize]) -> Option<f64>, options: Options) -> Vec<f64> {
    let mut generator = Pcg64::seed_from_u64(options.seed);
    let mut chosen = vec![0; strata.iter().sum()];
    let mut values = Vec::with_capacity(options.resamples);
    for _ in 0..options.resamples {
        let mut first = 0;
        for &size in strata {
            chosen[first..first + size].fill_with(|| first + below(&mut generator, size));
            first += size;
        }
        values.extend(statistic(&chosen));
    }
    values.sort_unstable_by(f64::total_cmp);
    values
}

/// A number below `bound`, each equally likely (Lemire 2019).
fn below(generator: &mut Pcg64, bound: usize) -> usize {
    let bound = bound as u64;
    let uneven = bound.wrapping_neg() % bound;
    loop {
        let product = u128::from(generator.next_u64()) * u128::from(bound);
        if product as u64 >= uneven {
            return (product >> 64) as usize;
        }
    }
}

/// Which quantiles of the (sorted) resamples bound the BCa interval; `None` where the correction does not exist.
fn bias_corrected(estimate: f64, resamples: &[f64], jackknife: &[f64], tail: f64) -> Option<(f64, f64)> {
    let below = resamples.partition_point(|&v| v < estimate);
    let not_above = resamples.partition_point(|&v| v <= estimate);
    let share = (below + not_above) as f64 / (2 * resamples.len()) as f64;
    if share <= 0.0 || share >= 1.0 {
        return None;
    }
    let bias = normal_quantile(share);
    let acceleration = acceleration(jackknife)?;
    let adjusted = |p: f64| {
        let z = bias + normal_quantile(p);
        normal_cdf(bias + z / (1.0 - acceleration * z))
    };
    Some((adjusted(tail), adjusted(1.0 - tail)))
}

/// A sixth of the skewness of the jackknife values.
fn acceleration(jackknife: &[f64]) -> Option<f64> {
    let mean = mean_of(jackknife);
    let (mut squares, mut cubes) = (0.0, 0.0);
    for value in jackknife {
        let deviation = mean - value;
        squares += deviation * deviation;
        cubes += deviation * deviation * deviation;
    }
    (squares > 0.0).then(|| cubes / (6.0 * squares * squares.sqrt()))
}

fn pick(values: &[f64], chosen: &[usize]) -> Vec<f64> {
    chosen.iter().map(|&i| values[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DATA: [f64; 10] = [0.8531, 0.9127, 0.9703, 0.8049, 0.9291, 0.9553, 0.7017, 0.9899, 0.8771, 0.9043];

    fn pairs() -> Paired {
        let second: Vec<f64> =
            DATA.iter().enumerate().map(|(i, v)| v - 0.0173 * v * (i % 4) as f64).collect();
        Paired::new(&DATA, &second).unwrap()
    }

    #[test]
    fn the_same_seed_gives_the_same_interval() {
        let with = |seed| mean_difference(&pairs(), Options { seed, ..Options::default() }).unwrap();
        assert_eq!(with(7), with(7));
        assert_ne!(with(7).interval, with(8).interval);
    }

    // scipy.stats.bootstrap((data,), np.mean, n_resamples=500_000), BCa: (0.8251, 0.9307), (0.8249, 0.9306) and
    // (0.8247, 0.9305) for rng 1, 2 and 3.
    #[test]
    fn agrees_with_scipys_bca_within_the_noise_of_resampling() {
        let options = Options { resamples: 200_000, ..Options::default() };
        let ours = bootstrap(&[10], |chosen| Some(mean_of(&pick(&DATA, chosen))), options).unwrap();
        assert_eq!(ours.method, Method::BiasCorrected);
        assert!((ours.interval.low - 0.8249).abs() < 0.0006, "{ours:?}");
        assert!((ours.interval.high - 0.9306).abs() < 0.0006, "{ours:?}");
    }

    // scipy.stats._resampling._bca_interval's formula on fixed resamples 1…9 and jackknife values.
    #[test]
    fn the_correction_itself_is_exact() {
        let resamples: Vec<f64> = (1..=9).map(f64::from).collect();
        let (low, high) = bias_corrected(4.0, &resamples, &[1.0, 2.0, 4.0, 9.0], 0.025).unwrap();
        assert!((low - 0.001_864_068_643_006_627).abs() < 1e-12, "{low}");
        assert!((high - 0.891_169_268_260_468_8).abs() < 1e-12, "{high}");
    }

    #[test]
    fn strata_are_never_mixed() {
        let options = Options { resamples: 300, ..Options::default() };
        let seen = std::cell::Cell::new(true);
        let statistic = |chosen: &[usize]| {
            seen.set(seen.get() && chosen[..3].iter().all(|&i| i < 3) && chosen[3..].iter().all(|&i| i >= 3));
            Some(chosen.iter().sum::<usize>() as f64)
        };
        assert_eq!(bootstrap(&[3, 2], statistic, options).unwrap().method, Method::Percentile);
        assert!(seen.get());
    }

    #[test]
    fn degenerate_data_and_options_get_a_reason() {
        let same = Paired::new(&[0.5; 4], &[0.25; 4]).unwrap();
        let constant = mean_difference(&same, Options::default()).unwrap();
        assert_eq!((constant.interval.low, constant.interval.high), (0.25, 0.25));
        assert_eq!(effect_size(&same, Options::default()), Err(Undefined::NoErrorVariation));
        assert!(mean_difference(&Paired::new(&[1.0], &[2.0]).unwrap(), Options::default()).is_err());
        assert!(mean_difference(&same, Options { level: 1.0, ..Options::default() }).is_err());
        assert!(stratified_interquartile_mean(&[vec![1.0, 2.0], vec![]], Options::default()).is_err());
    }

    #[test]
    fn draws_below_a_bound_are_even() {
        let mut generator = Pcg64::seed_from_u64(1);
        let mut counts = [0; 7];
        (0..70_000).for_each(|_| counts[below(&mut generator, 7)] += 1);
        assert!(counts.iter().all(|&c| (9_500..10_500).contains(&c)), "{counts:?}");
    }
}
