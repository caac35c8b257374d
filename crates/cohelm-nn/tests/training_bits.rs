//! Training gives the same bits for any number of threads, and on every CPU with fused multiply-add.
#![cfg(feature = "train")]

use cohelm_nn::adam::{Adam, AdamOptions, add_in_order, follow, norm};
use cohelm_nn::goal_head;
use cohelm_nn::lstm::{Lstm, LstmBatch, LstmShape};
use cohelm_nn::mlp::{Head, Mlp, MlpBatch, MlpShape};

fn uniform(seed: u32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    }
}

/// FNV-1a over the bits.
fn hash(numbers: &[f32]) -> u64 {
    let bytes = numbers.iter().flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

const ROWS: usize = 64;
const CHUNK: usize = 16;

/// Thirty steps towards made-up targets; chunks of the batch go to `threads` threads in turn.
fn train_mlp(threads: usize) -> Mlp {
    let shape = MlpShape::new(13, &[64, 64], Head::Dueling(4)).unwrap();
    let mut net = Mlp::new(&shape, uniform(1));
    let mut target = net.clone();
    let mut adam =
        Adam::new(shape.parameters(), AdamOptions { largest_norm: Some(0.5), ..Default::default() });
    let mut draw = uniform(2);
    let mut chunks = vec![(MlpBatch::new(&shape, CHUNK), vec![0.0; shape.parameters()]); ROWS / CHUNK];
    for _ in 0..30 {
        let x: Vec<f32> = (0..ROWS * 13).map(|_| 2.0 * draw() - 1.0).collect();
        let work: Vec<_> = chunks.iter_mut().zip(x.chunks_exact(CHUNK * 13)).collect();
        in_threads(work, threads, |((batch, gradient), x)| {
            let d: Vec<f32> = batch.forward(&net, x).iter().map(|q| (q - 1.0) / ROWS as f32).collect();
            batch.backward(&net, x, &d, gradient);
        });
        let mut sum = vec![0.0; shape.parameters()];
        chunks.iter().for_each(|(_, gradient)| add_in_order(&mut sum, gradient));
        adam.step(net.params_mut(), &sum, 1e-3);
        follow(target.params_mut(), net.params(), 0.1);
    }
    target
}

/// Deals `work` out to threads like cards.
fn in_threads<T: Send>(work: Vec<T>, threads: usize, job: impl Fn(T) + Sync) {
    let mut hands: Vec<Vec<T>> = (0..threads).map(|_| Vec::new()).collect();
    work.into_iter().enumerate().for_each(|(i, w)| hands[i % threads].push(w));
    std::thread::scope(|scope| {
        for hand in hands {
            scope.spawn(|| hand.into_iter().for_each(&job));
        }
    });
}

fn train_lstm() -> Lstm {
    let shape = LstmShape::new(10, 24, goal_head::OUTPUTS).unwrap();
    let mut net = Lstm::new(shape, uniform(3));
    let mut batch = LstmBatch::new(shape, 5, 12);
    let mut adam = Adam::new(shape.parameters(), AdamOptions::default());
    let mut gradient = vec![0.0; shape.parameters()];
    let mut draw = uniform(4);
    let lengths = [12, 3, 7, 12, 1];
    for _ in 0..30 {
        batch.begin(&lengths);
        for (s, &length) in lengths.iter().enumerate() {
            (0..length).for_each(|t| batch.input_mut(s, t).fill_with(|| 2.0 * draw() - 1.0));
        }
        batch.forward(&net);
        for (s, &length) in lengths.iter().enumerate() {
            for t in 0..length {
                let (outputs, gradient) = batch.output_and_gradient_mut(s, t);
                goal_head::cross_entropy(outputs, &[[0.5, 0.0], [-0.5, 0.2]], s % 2, 0.03, gradient);
            }
        }
        batch.backward(&net, &mut gradient);
        adam.step(net.params_mut(), &gradient, 1e-2);
    }
    net
}

#[test]
fn any_number_of_threads_gives_the_same_weights() {
    let alone = train_mlp(1);
    for threads in [2, 3, 4] {
        assert_eq!(train_mlp(threads), alone, "{threads} threads");
    }
}

/// Constants of a machine with AVX-512; one with AVX2 or NEON must find the same.
#[test]
fn every_cpu_with_fused_multiply_add_gives_the_same_weights() {
    let (mlp, lstm) = (hash(train_mlp(1).params()), hash(train_lstm().params()));
    if cohelm_nn::kernel_name().starts_with("fused") {
        assert_eq!((mlp, lstm), (0x5d1e_e440_0de9_f6ff, 0xcc5f_0a02_a687_cbf6), "{mlp:#018x} {lstm:#018x}");
    }
}

#[test]
fn norm_in_lanes_is_the_norm() {
    for n in [0, 1, 7, 8, 9, 100] {
        let gradient: Vec<f32> = (0..n).map(|i| i as f32 / 10.0).collect();
        let exact = gradient.iter().map(|g| f64::from(*g).powi(2)).sum::<f64>().sqrt();
        assert!((f64::from(norm(&gradient)) - exact).abs() <= 1e-6 * exact);
    }
}

#[test]
fn following_at_rate_one_copies() {
    let mut target = [1.0, 2.0];
    follow(&mut target, &[3.0, -4.0], 0.5);
    assert_eq!(target, [2.0, -1.0]);
    follow(&mut target, &[0.1, 0.2], 1.0);
    assert_eq!(target, [0.1, 0.2]);
}
