//! numpy's `Generator` as Gymnasium uses it: on top of the loop's own [`Draws`], whole numbers from half a draw.

use cohelm::random::Draws;
use serde::{Deserialize, Serialize};

/// `numpy.random.Generator(PCG64(SeedSequence(seed)))`: the same draws in the same order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Generator {
    draws: Draws,
    /// The upper half of the last 64 bits, if only the lower half has been used.
    half: Option<u32>,
}

impl Generator {
    /// Of a non-negative Python integer that fits 64 bits.
    pub fn new(seed: u64) -> Generator {
        Generator { draws: Draws::new(seed), half: None }
    }

    /// `uniform(low, high)`: in [low, high).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.draws.uniform(low, high)
    }

    /// `integers(low, high)`: in low..high, by Lemire's method on 32 bits.
    ///
    /// # Panics
    /// If `low` is not below `high`, or they are 2³² or more apart.
    pub fn integers(&mut self, low: i64, high: i64) -> i64 {
        assert!(low < high && high - low < 1 << 32, "integers({low}, {high})");
        let count = (high - low) as u32;
        let unbiased_from = count.wrapping_neg() % count;
        loop {
            let product = u64::from(self.half_draw()) * u64::from(count);
            if product as u32 >= unbiased_from {
                return low + (product >> 32) as i64;
            }
        }
    }

    /// 32 bits: the lower half of a fresh draw, then its upper half, whatever is drawn in between.
    fn half_draw(&mut self) -> u32 {
        self.half.take().unwrap_or_else(|| {
            let bits = self.draws.bits();
            self.half = Some((bits >> 32) as u32);
            bits as u32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// numpy 2.4.6: `g = np.random.default_rng(SEED); [g.integers(-9999, 9999), g.random(), g.integers(-9999, 9999),
    /// g.integers(0, 3_000_000_000), g.integers(0, 3_000_000_000), g.integers(0, 3_000_000_000)]`; the wide range makes
    /// numpy reject draws.
    #[test]
    fn whole_numbers_are_numpy_s() {
        for (seed, [a, b, wide @ ..], unit) in NUMPY {
            let mut generator = Generator::new(seed);
            assert_eq!(generator.integers(-9999, 9999), a, "seed {seed}");
            assert_eq!(generator.uniform(0.0, 1.0), unit, "seed {seed}");
            assert_eq!(generator.integers(-9999, 9999), b, "seed {seed}");
            let drawn: [i64; 3] = std::array::from_fn(|_| generator.integers(0, 3_000_000_000));
            assert_eq!(drawn, wide, "seed {seed}");
        }
    }

    const NUMPY: [(u64, [i64; 5], f64); 4] = [
        (0, [7011, 2738, 923488268, 122920571, 225720425], 0.2697867137638703),
        (1, [-537, 236, 104557657, 2845948340, 935494355], 0.9504636963259353),
        (12345678901, [-8241, 6722, 239403746, 194598857, 2565871452], 0.3167040550006629),
        (18446744073709551615, [959, 3600, 1075324467, 22209244, 300392691], 0.8453117585624743),
    ];
}
