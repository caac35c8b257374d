//! Draws from a seed: numpy's default generator, so that a plant of the Python world can be followed draw by draw.

use rand_core::Rng;
use rand_pcg::Lcg128Xsl64;
use serde::{Deserialize, Serialize};

/// A stream of random numbers fixed by one seed: PCG64 (XSL-RR 128/64), seeded through `SeedSequence` exactly as
/// `numpy.random.default_rng(seed)` is. Written down and read again it goes on where it was.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Draws {
    stream: Lcg128Xsl64,
}

impl Draws {
    /// The stream of `numpy.random.default_rng(seed)`.
    pub fn new(seed: u64) -> Self {
        let [a, b, c, d] = seed_sequence(seed);
        let wide = |high: u64, low: u64| (u128::from(high) << 64) | u128::from(low);
        Self { stream: Lcg128Xsl64::new(wide(a, b), wide(c, d)) }
    }

    /// A stream of its own for a numbered purpose, so that drawing more for one thing does not shift another.
    pub fn fork(seed: u64, purpose: u64) -> Self {
        Self::new(mix_seed(seed, purpose))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.stream.next_u64()
    }

    /// Uniform in [0, 1): numpy's `random()`.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in [low, high): numpy's `uniform(low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number in 0..n, without bias worth naming for the small `n` used here; 0 for `n` = 0.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// True with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A standard normal draw (Box–Muller on two uniform draws, the second half thrown away).
    pub fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.unit()));
        radius * libm::cos(core::f64::consts::TAU * self.unit())
    }
}

/// A seed for a numbered part of something that has a seed: SplitMix64's finaliser over both.
pub fn mix_seed(seed: u64, part: u64) -> u64 {
    let mut z = seed ^ part.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// numpy's `SeedSequence(seed).generate_state(4, uint64)`.
fn seed_sequence(seed: u64) -> [u64; 4] {
    let mut hash = 0x43b0_d7e5_u32;
    let mut hashed = |value: u32| {
        let value = value ^ hash;
        hash = hash.wrapping_mul(0x931e_8875);
        let value = value.wrapping_mul(hash);
        value ^ (value >> 16)
    };
    let mut pool = [seed as u32, (seed >> 32) as u32, 0, 0].map(&mut hashed);
    for from in 0..4 {
        for to in 0..4 {
            if from != to {
                let mixed = 0xca01_f9dd_u32
                    .wrapping_mul(pool[to])
                    .wrapping_sub(0x4973_f715_u32.wrapping_mul(hashed(pool[from])));
                pool[to] = mixed ^ (mixed >> 16);
            }
        }
    }
    let mut hash = 0x8b51_f9dd_u32;
    let mut word = |i: usize| {
        let value = pool[i % 4] ^ hash;
        hash = hash.wrapping_mul(0x58f3_8ded);
        let value = value.wrapping_mul(hash);
        u64::from(value ^ (value >> 16))
    };
    core::array::from_fn(|i| word(2 * i) | (word(2 * i + 1) << 32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_down_goes_on_where_it_was() {
        let mut draws = Draws::new(11);
        draws.bits();
        let mut read: Draws = serde_json::from_str(&serde_json::to_string(&draws).unwrap()).unwrap();
        assert_eq!([read.bits(), read.bits()], [draws.bits(), draws.bits()]);
    }

    // Recorded with numpy 2.4.6: g = np.random.default_rng(SEED); [float(g.random()).hex() for _ in range(3)], then
    // g.uniform(-2, 5).
    #[test]
    fn draws_are_numpys() {
        for (seed, units, uniform) in NUMPY {
            let mut draws = Draws::new(seed);
            assert_eq!([draws.unit(), draws.unit(), draws.unit()], units);
            assert_eq!(draws.uniform(-2.0, 5.0), uniform);
        }
    }

    const NUMPY: [(u64, [f64; 3], f64); 3] = include!("random_numpy.in");

    #[test]
    fn normal_draws_have_unit_spread() {
        let mut draws = Draws::new(7);
        let sample: Vec<f64> = (0..20_000).map(|_| draws.normal()).collect();
        let mean = sample.iter().sum::<f64>() / 20_000.0;
        let variance = sample.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 20_000.0;
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "mean {mean}, variance {variance}");
    }

    #[test]
    fn below_stays_below() {
        let mut draws = Draws::new(3);
        assert!((0..1000).all(|_| draws.below(3) < 3));
        assert_eq!(draws.below(0), 0);
    }
}
