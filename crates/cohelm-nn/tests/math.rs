//! The portable functions against `libm`'s f64 ones: accuracy, bounds, symmetry, order, and what NaN does.

use cohelm_nn::math::{exp, ln, sigmoid, softmax, tanh};
use proptest::prelude::*;

/// Distance from the exact result in units in the last place of f32 at that result.
fn ulps(found: f32, exact: f64) -> f64 {
    let above = f64::from((exact as f32).abs().max(f32::MIN_POSITIVE));
    let unit = f64::from(f32::from_bits((above as f32).to_bits() + 1)) - above;
    (f64::from(found) - exact).abs() / unit
}

fn exact_sigmoid(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}

/// What the documentation of a function claims.
struct Claim {
    name: &'static str,
    ours: fn(f32) -> f32,
    exact: fn(f64) -> f64,
    range: (f32, f32),
    most_ulps: f64,
}

const CLAIMS: [Claim; 3] = [
    Claim { name: "exp", ours: exp, exact: libm::exp, range: (-87.3, 88.722_83), most_ulps: 1.0 },
    Claim { name: "tanh", ours: tanh, exact: libm::tanh, range: (-20.0, 20.0), most_ulps: 1.4 },
    Claim { name: "sigmoid", ours: sigmoid, exact: exact_sigmoid, range: (-87.3, 88.0), most_ulps: 2.5 },
];

/// Every `stride`-th f32 from the range's low end to its high end, in rising order.
fn arguments((low, high): (f32, f32), stride: usize) -> impl Iterator<Item = f32> {
    let negative = (0..=(-low).to_bits()).rev().map(|b| -f32::from_bits(b));
    negative.chain((0..=high.to_bits()).map(f32::from_bits)).step_by(stride)
}

/// The largest error and the largest step back between neighbouring arguments, in ulps.
fn worst(claim: &Claim, stride: usize) -> (f64, u32) {
    let (mut error, mut back, mut before) = (0.0f64, 0, f32::NEG_INFINITY);
    for x in arguments(claim.range, stride) {
        let y = (claim.ours)(x);
        error = error.max(ulps(y, (claim.exact)(f64::from(x))));
        if y < before {
            back = back.max(y.to_bits().abs_diff(before.to_bits()));
        }
        before = y;
    }
    (error, back)
}

fn assert_claims(stride: usize) {
    for claim in &CLAIMS {
        let (error, back) = worst(claim, stride);
        println!("{}: {error:.3} ulp, {back} ulp back at most", claim.name);
        assert!(error <= claim.most_ulps, "{}: {error} ulp", claim.name);
        assert_eq!(back, 0, "{} must never fall", claim.name);
    }
}

#[test]
fn accuracy_and_order_over_a_sample() {
    assert_claims(4999);
}

#[test]
#[ignore = "every f32 in the ranges takes minutes; run with --release and --nocapture"]
fn accuracy_and_order_over_every_argument() {
    assert_claims(1);
}

#[test]
fn ends_of_the_ranges() {
    assert_eq!(exp(0.0), 1.0);
    assert_eq!(exp(-0.0), 1.0);
    assert_eq!(exp(f32::INFINITY), f32::INFINITY);
    assert_eq!(exp(88.722_84), f32::INFINITY);
    assert!(exp(88.722_83) < f32::INFINITY);
    assert_eq!(exp(-87.300_01), 0.0);
    assert!(exp(-87.3) >= f32::MIN_POSITIVE);
    assert_eq!(exp(f32::NEG_INFINITY), 0.0);
    assert_eq!([tanh(9.02), tanh(f32::MAX), tanh(f32::INFINITY)], [1.0; 3]);
    assert_eq!([sigmoid(0.0), sigmoid(90.0), sigmoid(f32::INFINITY)], [0.5, 1.0, 1.0]);
    assert_eq!([sigmoid(-90.0), sigmoid(f32::NEG_INFINITY)], [0.0, 0.0]);
    assert_eq!(tanh(-0.0).to_bits(), (-0.0f32).to_bits());
}

#[test]
fn nan_gives_nan() {
    assert!(exp(f32::NAN).is_nan() && tanh(f32::NAN).is_nan() && sigmoid(f32::NAN).is_nan());
    assert!(ln(f32::NAN).is_nan() && ln(-1.0).is_nan());
}

#[test]
fn softmax_of_one_and_of_none() {
    let mut one = [-1e30];
    softmax(&mut one);
    assert_eq!(one, [1.0]);
    softmax(&mut []);
}

proptest! {
    /// For any bit pattern: a result in the function's range, or NaN for NaN.
    #[test]
    fn results_stay_in_range(bits: u32) {
        let x = f32::from_bits(bits);
        let (e, t, s) = (exp(x), tanh(x), sigmoid(x));
        if x.is_nan() {
            prop_assert!(e.is_nan() && t.is_nan() && s.is_nan());
        } else {
            prop_assert!(e >= 0.0 && (-1.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s));
            prop_assert_eq!((-t).to_bits(), tanh(-x).to_bits());
        }
    }

    #[test]
    fn softmax_is_a_distribution_and_keeps_the_order(mut logits in prop::collection::vec(-50f32..50.0, 1..8)) {
        let before = logits.clone();
        softmax(&mut logits);
        prop_assert!((logits.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        for i in 0..logits.len() {
            for j in 0..logits.len() {
                prop_assert!(before[i] <= before[j] || logits[i] >= logits[j]);
            }
        }
    }

    /// A shift that f32 represents exactly changes no bit.
    #[test]
    fn softmax_ignores_a_shift(numerators in prop::collection::vec(-64i16..64, 1..8), shift in -64i16..64) {
        let logits = |shift: i16| -> Vec<f32> {
            let mut l: Vec<f32> = numerators.iter().map(|n| f32::from(n + shift) / 8.0).collect();
            softmax(&mut l);
            l
        };
        prop_assert_eq!(logits(0), logits(shift));
    }
}
