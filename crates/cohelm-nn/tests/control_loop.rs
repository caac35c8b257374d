//! The control loop's forward passes: their bits, and that they compute what training computes.

use cohelm_nn::fingerprint;

/// The same constant is demanded of the page's WebAssembly and of every CPU; a difference here means that
/// recorded decisions cannot be reproduced.
#[test]
fn bits_are_those_of_every_other_target() {
    assert_eq!(fingerprint::control_loop(), fingerprint::EXPECTED, "{:#018x}", fingerprint::control_loop());
}

#[cfg(feature = "train")]
mod beside_training {
    use cohelm_nn::critic::{Critic, CriticBatch, CriticScratch, CriticShape, Embedded};
    use cohelm_nn::lstm::{Lstm, LstmBatch, LstmShape, LstmState};
    use cohelm_nn::mlp::{Head, Mlp, MlpBatch, MlpScratch, MlpShape};
    use proptest::prelude::*;

    fn uniform(seed: u32) -> impl FnMut() -> f32 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        }
    }

    fn close(a: &[f32], b: &[f32]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5 * a.abs().max(1.0))
    }

    fn head(dueling: bool, n: usize) -> Head {
        if dueling { Head::Dueling(n) } else { Head::Plain(n) }
    }

    proptest! {
        #[test]
        fn mlp_passes_agree(
            seed: u32,
            input in 1usize..30,
            hidden in prop::collection::vec(1usize..70, 0..3),
            outputs in 1usize..7,
            dueling: bool,
            rows in 1usize..20,
        ) {
            let shape = MlpShape::new(input, &hidden, head(dueling, outputs)).unwrap();
            let net = Mlp::new(&shape, uniform(seed));
            let mut draw = uniform(!seed);
            let x: Vec<f32> = (0..rows * input).map(|_| 4.0 * draw() - 2.0).collect();
            let mut batch = MlpBatch::new(&shape, 20);
            let mut scratch = MlpScratch::new(&shape);
            let together = batch.forward(&net, &x);
            for (x, expected) in x.chunks_exact(input).zip(together.chunks_exact(outputs)) {
                let alone = net.forward(x, &mut scratch);
                prop_assert!(close(alone, expected), "{:?} {:?}", alone, expected);
            }
        }

        #[test]
        fn critic_passes_agree(
            seed: u32,
            input in 1usize..20,
            hidden in prop::collection::vec(1usize..70, 0..3),
            action in 1usize..25,
            width in 1usize..70,
            rows in 1usize..9,
            count in 1usize..40,
        ) {
            let shape = CriticShape::new(input, &hidden, action, width).unwrap();
            let critic = Critic::new(&shape, uniform(seed));
            let mut draw = uniform(!seed);
            let x: Vec<f32> = (0..rows * input).map(|_| 4.0 * draw() - 2.0).collect();
            // Half of the numbers are left out, as an encoding leaves out zeros.
            let mut number = || if draw() < 0.5 { 0.0 } else { 4.0 * draw() - 2.0 };
            let actions: Vec<f32> = (0..count * action).map(|_| number()).collect();
            let mut batch = CriticBatch::new(&shape, &actions, rows, count);
            let mut embedded = Embedded::new(&shape, count);
            let phis: Vec<Vec<f32>> = actions.chunks_exact(action).map(|a| {
                let features: Vec<_> = a.iter().copied().enumerate().filter(|(_, x)| *x != 0.0).collect();
                let mut phi = vec![0.0; width];
                critic.embed(&features, &mut phi);
                phi
            }).collect();
            let mean: Vec<f32> = (0..width).map(|k| phis.iter().map(|phi| phi[k]).sum::<f32>() / count as f32).collect();
            phis.iter().enumerate().for_each(|(i, phi)| embedded.set(i, phi, &mean));
            let (mut scratch, mut alone) = (CriticScratch::new(&shape), vec![0.0; count]);
            batch.look(&critic, &x);
            let together = batch.every(&critic, &actions).to_vec();
            for (x, expected) in x.chunks_exact(input).zip(together.chunks_exact(count)) {
                critic.look(x, &mut scratch);
                critic.values(&scratch, &embedded, &mut alone);
                prop_assert!(close(&alone, expected), "{:?} {:?}", alone, expected);
            }
            let pairs = rows.min(count);
            let each = batch.each(&critic, &actions[..pairs * action]);
            let diagonal: Vec<f32> = (0..pairs).map(|i| together[i * count + i]).collect();
            prop_assert!(close(each, &diagonal), "{:?} {:?}", each, diagonal);
        }

        #[test]
        fn lstm_passes_agree(
            seed: u32,
            input in 1usize..12,
            hidden in 1usize..40,
            lengths in prop::collection::vec(0usize..12, 1..6),
        ) {
            let shape = LstmShape::new(input, hidden, 3).unwrap();
            let net = Lstm::new(shape, uniform(seed));
            let mut draw = uniform(!seed);
            let mut batch = LstmBatch::new(shape, 6, 12);
            batch.begin(&lengths);
            for (s, &length) in lengths.iter().enumerate() {
                for t in 0..length {
                    batch.input_mut(s, t).fill_with(|| 4.0 * draw() - 2.0);
                }
            }
            batch.forward(&net);
            for (s, &length) in lengths.iter().enumerate() {
                let mut state = LstmState::new(shape);
                for t in 0..length {
                    let x = batch.input_mut(s, t).to_vec();
                    let alone = net.step(&x, &mut state);
                    prop_assert!(close(alone, batch.output(s, t)), "{:?} {:?}", alone, batch.output(s, t));
                }
            }
        }
    }

    #[test]
    fn a_reset_state_is_a_new_state() {
        let net = Lstm::new(LstmShape::new(2, 8, 1).unwrap(), uniform(1));
        let mut state = LstmState::new(net.shape());
        let first = net.step(&[1.0, -1.0], &mut state).to_vec();
        net.step(&[0.3, 0.4], &mut state);
        state.reset();
        assert_eq!(net.step(&[1.0, -1.0], &mut state), first);
    }
}
