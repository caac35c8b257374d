//! Sine and cosine of an `f32`, with the bits of glibc on x86-64.
//!
//! Box2D turns angles into rotations with the C library's `sinf` and `cosf`, so parity needs those functions' rounding
//! errors too. The method is that of ARM's optimized routines, which glibc uses: reduce to ±π/4 in f64, two short polynomials
//! in f64, one rounding to f32 at the end. A correctly rounded sine and crate `libm`'s `sinf` have other bits in 0.9 % and
//! 0.5 % of values. Every operation here is one IEEE addition or multiplication, so all targets agree.

/// Coefficients of x³, x⁵, x⁷ of the sine on ±π/4, as published with the method.
const SINE: [f64; 3] = [-0.16666654943701084, 0.008332178146138854, -0.00019517298981385725];
/// Coefficients of x², x⁴, x⁶, x⁸ of the cosine on ±π/4.
const COSINE: [f64; 4] =
    [-0.49999999725108224, 0.041666623324344516, -0.001388676379437604, 2.4390450703564542e-05];
/// Below this, no reduction is needed.
const QUARTER_PI: f32 = std::f32::consts::FRAC_PI_4;
/// From this magnitude on the fast reduction would lose bits.
const FAST_REDUCTION_LIMIT: f32 = 120.0;
/// Below this magnitude sin x rounds to x and cos x to 1.
const TINY: f32 = 1.0 / 4096.0;
/// 2²⁴ · 2/π: multiplying by it leaves the quadrant in the bits above the 24th.
const QUADRANTS_2_24: f64 = 10680707.430881744;
/// π/2 · 2⁻⁶².
const HALF_PI_2_62: f64 = 3.4061215800865545e-19;
/// The bits of 4/π, 32 at a time, every entry 8 bits further on.
const FOUR_OVER_PI: [u32; 24] = [
    0xa2, 0xa2f9, 0xa2f983, 0xa2f9836e, 0xf9836e4e, 0x836e4e44, 0x6e4e4415, 0x4e441529, 0x441529fc,
    0x1529fc27, 0x29fc2757, 0xfc2757d1, 0x2757d1f5, 0x57d1f534, 0xd1f534dd, 0xf534ddc0, 0x34ddc0db,
    0xddc0db62, 0xc0db6295, 0xdb629599, 0x6295993c, 0x95993c43, 0x993c4390, 0x3c439041,
];

/// (sin, cos) of `angle_rad`. NaN for what is not finite.
#[inline]
pub(crate) fn sin_cos(angle_rad: f32) -> (f32, f32) {
    let magnitude = angle_rad.abs();
    if magnitude < TINY {
        (angle_rad, 1.0)
    } else if magnitude < QUARTER_PI {
        let (sin, cos) = on_quarter_pi(f64::from(angle_rad));
        (sin as f32, cos as f32)
    } else if magnitude < FAST_REDUCTION_LIMIT {
        let x = f64::from(angle_rad);
        let quadrant = ((x * QUADRANTS_2_24) as i32).wrapping_add(0x80_0000) >> 24;
        in_quadrant(x - f64::from(quadrant) * std::f64::consts::FRAC_PI_2, quadrant as u32)
    } else if angle_rad.is_finite() {
        let (x, quadrant) = reduce_large(magnitude);
        let (sin, cos) = in_quadrant(x, quadrant);
        (if angle_rad < 0.0 { -sin } else { sin }, cos)
    } else {
        (f32::NAN, f32::NAN)
    }
}

/// sin and cos of x + quadrant · π/2, |x| ≤ π/4, rounded once.
#[inline]
fn in_quadrant(x: f64, quadrant: u32) -> (f32, f32) {
    let (sin, cos) = on_quarter_pi(x);
    let (sin, cos) = (sin as f32, cos as f32);
    match quadrant & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The two polynomials for |x| ≤ π/4, in the published order of operations.
#[inline]
fn on_quarter_pi(x: f64) -> (f64, f64) {
    let x2 = x * x;
    let x3 = x2 * x;
    let x4 = x2 * x2;
    let sin = (x + x3 * SINE[0]) + (x3 * x2) * (SINE[1] + x2 * SINE[2]);
    let cos = ((1.0 + x2 * COSINE[0]) + x4 * COSINE[1]) + (x4 * x2) * (COSINE[2] + x2 * COSINE[3]);
    (sin, cos)
}

/// Remainder and quadrant of a large positive number, by multiplying its mantissa with the bits of 4/π that matter.
#[cold]
fn reduce_large(magnitude: f32) -> (f64, u32) {
    let bits = magnitude.to_bits();
    let words = &FOUR_OVER_PI[(bits >> 26) as usize & 15..];
    let mantissa = ((bits & 0xff_ffff) | 0x80_0000) << ((bits >> 23) & 7);
    let high = u64::from(mantissa.wrapping_mul(words[0])) << 32;
    let middle = u64::from(mantissa) * u64::from(words[4]);
    let low = (u64::from(mantissa) * u64::from(words[8])) >> 32;
    let product = (high | low).wrapping_add(middle);
    let quadrant = product.wrapping_add(1 << 61) >> 62;
    let remainder = product.wrapping_sub(quadrant << 62) as i64;
    (remainder as f64 * HALF_PI_2_62, quadrant as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// sinf and cosf of glibc 2.36 on x86-64, recorded by `tests/data/record_sincosf.c`: every 1,048,573rd bit pattern.
    const GLIBC: &[u8] = include_bytes!("../../tests/data/sincosf.bin");

    #[test]
    fn every_recorded_value_has_glibc_s_bits() {
        let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        assert!(GLIBC.len() > 12 * 9_000);
        for row in GLIBC.chunks_exact(12) {
            let x = f32::from_bits(word(row));
            let (sin, cos) = sin_cos(x);
            assert_eq!((sin.to_bits(), cos.to_bits()), (word(&row[4..]), word(&row[8..])), "x = {x:e}");
        }
    }

    #[test]
    fn what_is_not_finite_gives_nan() {
        for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (sin, cos) = sin_cos(x);
            assert!(sin.is_nan() && cos.is_nan());
        }
    }
}
