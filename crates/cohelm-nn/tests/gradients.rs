//! Every gradient of the crate against central finite differences of its own forward pass.
#![cfg(feature = "train")]

use cohelm_nn::critic::{Critic, CriticBatch, CriticShape};
use cohelm_nn::goal_head;
use cohelm_nn::loss;
use cohelm_nn::lstm::{Lstm, LstmBatch, LstmShape};
use cohelm_nn::mlp::{Head, Mlp, MlpBatch, MlpShape};

/// Uniform numbers in [0, 1), the same every run.
fn uniform(seed: u32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    }
}

fn numbers(seed: u32, n: usize) -> Vec<f32> {
    let mut u = uniform(seed);
    (0..n).map(|_| 4.0 * u() - 2.0).collect()
}

/// Compares `gradient` with differences of `loss` at `at`.
///
/// The forward pass is f32: the step balances its rounding (some 1e-6 / step) against curvature. Where ReLU
/// bends inside the step the central difference is wrong but that of the side without the bend is right
/// (ReLU networks are piecewise linear in one parameter), so the best of the three counts.
fn assert_gradient(at: &mut [f32], gradient: &[f32], mut loss: impl FnMut(&[f32]) -> f64) {
    let step = 5e-3f32;
    for i in 0..at.len() {
        let x = at[i];
        let mut loss_at = |x: f32| {
            at[i] = x;
            (loss(at), f64::from(x))
        };
        let (below, here, above) = (loss_at(x - step), loss_at(x), loss_at(x + step));
        at[i] = x;
        let differences =
            [(below, above), (below, here), (here, above)].map(|(a, b)| (b.0 - a.0) / (b.1 - a.1));
        let close = |d: &f64| (d - f64::from(gradient[i])).abs() < 1e-3 + 1e-3 * d.abs();
        assert!(differences.iter().any(close), "parameter {i}: gradient {}, {differences:?}", gradient[i]);
    }
}

/// Σ wᵢ yᵢ in f64: a loss whose gradient at the outputs is w.
fn weighted(y: &[f32], w: &[f32]) -> f64 {
    y.iter().zip(w).map(|(y, w)| f64::from(*y) * f64::from(*w)).sum()
}

fn check_mlp(hidden: &[usize], head: Head) {
    let shape = MlpShape::new(5, hidden, head).unwrap();
    let mut net = Mlp::new(&shape, uniform(3));
    let rows = 7;
    let x = numbers(4, rows * 5);
    let w = numbers(5, rows * shape.outputs());
    let mut batch = MlpBatch::new(&shape, rows);
    let mut gradient = vec![f32::NAN; shape.parameters()];
    batch.forward(&net, &x);
    batch.backward(&net, &x, &w, &mut gradient);
    let mut params = net.params().to_vec();
    assert_gradient(&mut params, &gradient, |p| {
        net.params_mut().copy_from_slice(p);
        weighted(batch.forward(&net, &x), &w)
    });
}

#[test]
fn mlp_without_hidden_layers() {
    check_mlp(&[], Head::Plain(3));
}

#[test]
fn mlp_with_dueling_head_and_no_hidden_layer() {
    check_mlp(&[], Head::Dueling(3));
}

#[test]
fn mlp_with_two_hidden_layers() {
    check_mlp(&[8, 6], Head::Plain(2));
}

#[test]
fn dueling_mlp_with_two_hidden_layers() {
    check_mlp(&[8, 6], Head::Dueling(4));
}

#[test]
fn gradient_of_the_first_rows_ignores_the_others() {
    let shape = MlpShape::new(5, &[9, 6], Head::Dueling(4)).unwrap();
    let net = Mlp::new(&shape, uniform(3));
    let x = numbers(4, 6 * 5);
    let w = numbers(5, 4 * 4);
    let (mut some, mut only) = (vec![0.0; shape.parameters()], vec![0.0; shape.parameters()]);
    let mut batch = MlpBatch::new(&shape, 6);
    batch.forward(&net, &x);
    batch.backward(&net, &x[..4 * 5], &w, &mut some);
    batch.forward(&net, &x[..4 * 5]);
    batch.backward(&net, &x[..4 * 5], &w, &mut only);
    assert_eq!(some, only);
}

#[test]
fn lstm_over_sequences_of_unequal_length() {
    let shape = LstmShape::new(3, 4, 2).unwrap();
    let mut net = Lstm::new(shape, uniform(8));
    let lengths = [3, 0, 5, 1, 5];
    let x = numbers(9, 5 * 5 * 3);
    let w = numbers(10, 5 * 5 * 2);
    let mut batch = LstmBatch::new(shape, 5, 5);
    let loss = |net: &Lstm, batch: &mut LstmBatch| {
        batch.begin(&lengths);
        for (s, t) in ticks(&lengths) {
            batch.input_mut(s, t).copy_from_slice(&x[(s * 5 + t) * 3..][..3]);
        }
        batch.forward(net);
        let mut sum = 0.0;
        for (s, t) in ticks(&lengths) {
            let w = &w[(s * 5 + t) * 2..][..2];
            let (y, gradient) = batch.output_and_gradient_mut(s, t);
            sum += weighted(y, w);
            gradient.copy_from_slice(w);
        }
        sum
    };
    let mut gradient = vec![f32::NAN; shape.parameters()];
    loss(&net, &mut batch);
    batch.backward(&net, &mut gradient);
    let mut params = net.params().to_vec();
    assert_gradient(&mut params, &gradient, |p| {
        net.params_mut().copy_from_slice(p);
        loss(&net, &mut batch)
    });
}

fn ticks(lengths: &[usize]) -> impl Iterator<Item = (usize, usize)> {
    lengths.iter().enumerate().flat_map(|(s, &length)| (0..length).map(move |t| (s, t)))
}

#[test]
fn huber_on_both_sides_of_its_bend() {
    for error in [-3.0, -1.2, -0.4, 0.3, 0.9, 2.5] {
        let (_, gradient) = loss::huber(error, 1.0);
        assert_gradient(&mut [error], &[gradient], |e| f64::from(loss::huber(e[0], 1.0).0));
    }
}

#[test]
fn mean_squared_error() {
    let target = numbers(1, 4);
    let mut prediction = numbers(2, 4);
    let mut gradient = [0.0; 4];
    loss::mean_squared(&prediction, &target, 0.5, &mut gradient);
    let mut unused = [0.0; 4];
    assert_gradient(&mut prediction, &gradient, |p| {
        0.5 * f64::from(loss::mean_squared(p, &target, 0.5, &mut unused))
    });
}

#[test]
fn cross_entropy_of_logits() {
    let mut logits = numbers(6, 5);
    let mut gradient = [0.0; 5];
    loss::cross_entropy(&logits, 3, 0.5, &mut gradient);
    let mut unused = [0.0; 5];
    assert_gradient(&mut logits, &gradient, |l| f64::from(0.5 * loss::cross_entropy(l, 3, 0.5, &mut unused)));
}

#[test]
fn calibrated_head() {
    let goals = [[-0.5, 0.1], [0.25, 0.0], [0.75, -0.2]];
    for ln_sigma in [-1.0, 0.0, 1.5] {
        let mut outputs = [0.1, -0.3, ln_sigma];
        let mut gradient = [0.0; 3];
        goal_head::cross_entropy(&outputs, &goals, 2, 0.5, &mut gradient);
        let mut unused = [0.0; 3];
        assert_gradient(&mut outputs, &gradient, |o| {
            f64::from(0.5 * goal_head::cross_entropy(o, &goals, 2, 0.5, &mut unused))
        });
    }
}

#[test]
fn imagining_head() {
    for ln_sigma in [-1.0, 0.0, 1.5] {
        let mut outputs = [0.1, -0.3, ln_sigma];
        let mut gradient = [0.0; 3];
        goal_head::surprise(&outputs, &[0.75, -0.2], 0.5, &mut gradient);
        let mut unused = [0.0; 3];
        assert_gradient(&mut outputs, &gradient, |o| {
            f64::from(0.5 * goal_head::surprise(o, &[0.75, -0.2], 0.5, &mut unused))
        });
    }
}

#[test]
fn calibrated_head_out_of_range_is_pulled_back_only() {
    let goals = [[0.0, 0.0], [1.0, 0.0]];
    let mut gradient = [0.0; 3];
    // Right and already sharper than allowed: cross-entropy would sharpen on, the range says no.
    goal_head::cross_entropy(&[0.499, 0.0, -6.5], &goals, 0, 1.0, &mut gradient);
    assert_eq!(gradient[2], 0.0);
    // Wrong and too sharp: the gradient must still lead back.
    goal_head::cross_entropy(&[0.501, 0.0, -6.5], &goals, 0, 1.0, &mut gradient);
    assert!(gradient[2] < 0.0, "{gradient:?}");
}

fn check_critic(hidden: &[usize]) {
    let shape = CriticShape::new(5, hidden, 3, 20).unwrap();
    let mut critic = Critic::new(&shape, uniform(3));
    let rows = 7;
    let (x, actions, reference) = (numbers(4, rows * 5), numbers(6, rows * 3), numbers(7, 4 * 3));
    let w = numbers(5, rows);
    let mut batch = CriticBatch::new(&shape, &reference, rows, rows);
    let mut gradient = vec![f32::NAN; shape.parameters()];
    batch.look(&critic, &x);
    batch.each(&critic, &actions);
    batch.backward(&critic, &x, &w, &mut gradient);
    let mut params = critic.params().to_vec();
    assert_gradient(&mut params, &gradient, |p| {
        critic.params_mut().copy_from_slice(p);
        batch.look(&critic, &x);
        weighted(batch.each(&critic, &actions), &w)
    });
}

#[test]
fn critic_without_hidden_layers() {
    check_critic(&[]);
}

#[test]
fn critic_with_two_hidden_layers() {
    check_critic(&[8, 6]);
}
