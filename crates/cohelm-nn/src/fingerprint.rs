//! A number that two builds share exactly if their control loops give the same bits.

use crate::goal_head;
use crate::lstm::{Lstm, LstmShape, LstmState};
use crate::math::{exp, sigmoid, tanh};
use crate::mlp::{Head, Mlp, MlpScratch, MlpShape};

/// What [`control_loop`] gives on every CPU and in WebAssembly. It changes only with a change of the
/// arithmetic, and then every recorded decision is of another version.
pub const EXPECTED: u64 = 0x2948_26c8_e135_29fb;

/// FNV-1a over the bits of a fixed computation: the portable functions over their range, 40 ticks of an LSTM
/// with the calibrated head, and a dueling network on its inputs, of the sizes of the shipped models.
///
/// Weights and inputs come from integers, so nothing but the arithmetic under test is in it. Takes less than a
/// millisecond.
#[must_use]
pub fn control_loop() -> u64 {
    let mut hash = Fnv::default();
    functions(&mut hash);
    networks(&mut hash);
    hash.finish()
}

fn functions(hash: &mut Fnv) {
    for i in -4000..=4000 {
        let x = i as f32 / 41.0;
        hash.write(&[exp(x), tanh(x / 8.0), sigmoid(x)]);
    }
}

fn networks(hash: &mut Fnv) {
    let mut draw = Draw(20);
    let lstm_shape = LstmShape::new(26, 64, goal_head::OUTPUTS).expect("widths within the limits");
    let lstm = Lstm::new(lstm_shape, || 0.5 + 0.5 * draw.next());
    let mut draw = Draw(13);
    let mlp_shape = MlpShape::new(13, &[64, 64], Head::Dueling(4)).expect("widths within the limits");
    let mlp = Mlp::new(&mlp_shape, || 0.5 + 0.5 * draw.next());
    let mut state = LstmState::new(lstm_shape);
    let mut scratch = MlpScratch::new(&mlp_shape);
    let goals = [[-0.5, 0.1], [0.25, 0.0], [0.75, -0.2]];
    let mut probabilities = [0.0; 3];
    let mut draw = Draw(7);
    for _ in 0..40 {
        let x: [f32; 26] = std::array::from_fn(|_| draw.next());
        let intent = lstm.step(&x, &mut state);
        hash.write(intent);
        goal_head::probabilities(intent, &goals, &mut probabilities);
        hash.write(&probabilities);
        hash.write(mlp.forward(&x[..13], &mut scratch));
    }
}

/// Numbers in [−1, 1) with 24 bits, exact in f32.
struct Draw(u32);

impl Draw {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}

/// FNV-1a, 64 bits, over the bit patterns of f32 numbers (little end first).
#[derive(Clone, Copy)]
pub(crate) struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    pub fn write(&mut self, numbers: &[f32]) {
        for byte in numbers.iter().flat_map(|x| x.to_bits().to_le_bytes()) {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    pub fn finish(self) -> u64 {
        self.0
    }
}
