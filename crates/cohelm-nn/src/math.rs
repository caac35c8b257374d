//! exp, tanh, sigmoid and softmax in f32 with the same bits on every CPU and in WebAssembly.
//!
//! Everything here is additions, multiplications, divisions, comparisons and integer work on the bits, in an
//! order that the source fixes: no fused multiply-add, no call into a platform's mathematical library, no
//! table. The functions have no branches, so that loops over them become vector code without changing a bit.
//!
//! Accuracy, measured over all finite f32 arguments against `libm`'s f64 functions
//! (`cargo test --release -p cohelm-nn --test math -- --ignored --nocapture`), in units in the last place:
//! exp 1.0, tanh 1.4, sigmoid 2.5; none of them ever falls where it should rise. NaN gives NaN (its payload is
//! not part of the contract).

/// exp(r) = 1 + r + r²·P(r) for |r| ≤ ln(2)/2; minimax fit of `tests/data/fit_functions.py`, error 3.1e-9.
const P: [f32; 5] = [0.499_999_94, 0.166_665_21, 0.041_668_262, 0.008_368_676, 0.001_382_111_7];
/// tanh(x) = x + x³·Q(x²) for |x| ≤ 0.625; fit of the same recipe, relative error 4.5e-9.
const Q: [f32; 5] = [-0.333_332_8, 0.133_314_13, -0.053_737_562, 0.020_632_64, -0.005_698_251_5];
/// ln(2) in two parts: the first has so few bits that n·LN2_HIGH is exact for every n that occurs.
const LN2_HIGH: f32 = 0.693_359_4;
const LN2_LOW: f32 = -2.121_944_4e-4;
/// Adding 1.5·2²³ rounds to the nearest integer and leaves that integer in the low bits of the sum.
const ROUND: f32 = 12_582_912.0;

/// Above this exp is infinite, ln of the largest f32.
const EXP_HIGHEST: f32 = 88.722_83;
/// Below this exp is 0: true results from here down are at most 1.22e-38, the end of the normal numbers.
const EXP_LOWEST: f32 = -87.3;

/// eˣ. Infinite above 88.722_83, 0 below −87.3 (no subnormal results).
#[inline(always)]
#[must_use]
pub fn exp(x: f32) -> f32 {
    let shifted = x * core::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * LN2_HIGH) - n * LN2_LOW;
    let p = (((P[4] * r + P[3]) * r + P[2]) * r + P[1]) * r + P[0];
    let fraction = 1.0 + (r + r * r * p);
    // n sits in the low bits of `shifted`: moved to the exponent's place and added it multiplies by 2ⁿ.
    let y = f32::from_bits(fraction.to_bits().wrapping_add(shifted.to_bits() << 23));
    let y = if x > EXP_HIGHEST { f32::INFINITY } else { y };
    let y = if x < EXP_LOWEST { 0.0 } else { y };
    if x.is_nan() { x } else { y }
}

/// tanh x, odd to the last bit: tanh(−x) = −tanh(x); ±1 from |x| = 9.02 on, where f32 has nothing nearer.
#[inline(always)]
#[must_use]
pub fn tanh(x: f32) -> f32 {
    let magnitude = x.abs();
    let square = magnitude * magnitude;
    let q = (((Q[4] * square + Q[3]) * square + Q[2]) * square + Q[1]) * square + Q[0];
    let small = magnitude + magnitude * square * q;
    let large = 1.0 - 2.0 / (exp(magnitude + magnitude) + 1.0);
    let y = if magnitude > 0.625 { large } else { small };
    y.copysign(x)
}

/// 1 / (1 + e⁻ˣ); 0 below −88.722_83.
#[inline(always)]
#[must_use]
pub fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + exp(-x))
}

/// Natural logarithm (crate `libm`, the same source on every target).
#[must_use]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// Turns logits into probabilities in place; subtracting the largest first, so no finite logit overflows.
///
/// An empty slice stays empty. The sum runs from first to last, whatever the length.
pub fn softmax(logits: &mut [f32]) {
    normalise(logits);
}

/// The same, and returns the logarithm of the sum of the exponentials of the logits.
pub fn softmax_log_sum(logits: &mut [f32]) -> f32 {
    let (largest, sum) = normalise(logits);
    largest + ln(sum)
}

/// Softmax in place; returns the largest logit and the sum of exponentials of the differences from it.
fn normalise(logits: &mut [f32]) -> (f32, f32) {
    let largest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut sum = 0.0;
    for logit in logits.iter_mut() {
        *logit = exp(*logit - largest);
        sum += *logit;
    }
    for p in logits {
        *p /= sum;
    }
    (largest, sum)
}
