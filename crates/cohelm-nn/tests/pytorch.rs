//! Outputs, losses, gradients and Adam against numbers recorded from PyTorch.
//!
//! Recipe: `tests/data/record_pytorch.py` (PyTorch 2.15.0, computing in f64 from f32 weights and inputs).
#![cfg(feature = "train")]

use cohelm_nn::adam::{Adam, AdamOptions};
use cohelm_nn::goal_head;
use cohelm_nn::loss;
use cohelm_nn::lstm::{Lstm, LstmBatch, LstmState};
use cohelm_nn::mlp::{Mlp, MlpBatch, MlpScratch};
use cohelm_nn::weights::TensorFile;
use serde_json::Value;

fn record() -> Value {
    serde_json::from_str(include_str!("data/pytorch.json")).unwrap()
}

fn numbers(tensor: &Value) -> Vec<f32> {
    tensor["data"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap() as f32).collect()
}

/// Named tensors as PyTorch's `state_dict` has them.
fn tensors(named: &Value) -> TensorFile {
    let mut file = TensorFile::new();
    for (name, tensor) in named.as_object().unwrap() {
        let shape: Vec<usize> =
            tensor["shape"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap() as usize).collect();
        file.insert(name, &shape, numbers(tensor));
    }
    file
}

/// Relative to the larger of the expected number and 0.1: gradients are sums of terms of about that size.
fn assert_close(what: &str, found: &[f32], expected: &[f32], tolerance: f32) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (i, (f, e)) in found.iter().zip(expected).enumerate() {
        let error = (f - e).abs() / e.abs().max(0.1);
        assert!(error < tolerance, "{what}[{i}]: {f} found, PyTorch has {e}");
    }
}

fn mlp(named: &Value) -> Mlp {
    Mlp::load(&tensors(named), "").unwrap()
}

/// Loss and output gradients of a batch.
fn mlp_loss(case: &Value, outputs: &[f32], gradient: &mut [f32]) -> f32 {
    let target = numbers(&case["target"]);
    if case["loss_name"] == "mse" {
        return loss::mean_squared(outputs, &target, 1.0, gradient);
    }
    let rows = target.len();
    let width = outputs.len() / rows;
    gradient.fill(0.0);
    let mut sum = 0.0;
    for (row, target) in target.iter().enumerate() {
        let at = row * width + row % width;
        let (value, slope) = loss::huber(outputs[at] - target, 1.0);
        gradient[at] = slope / rows as f32;
        sum += value;
    }
    sum / rows as f32
}

fn check_mlp(case: &Value) {
    let mut net = mlp(&case["weights"]);
    let x = numbers(&case["x"]);
    let mut batch = MlpBatch::new(net.shape(), 6);
    let outputs = batch.forward(&net, &x).to_vec();
    assert_close("outputs", &outputs, &numbers(&case["outputs"]), 2e-6);

    let mut d_outputs = vec![0.0; outputs.len()];
    let value = mlp_loss(case, &outputs, &mut d_outputs);
    assert_close("loss", &[value], &[case["loss"].as_f64().unwrap() as f32], 2e-6);
    let mut gradient = vec![0.0; net.params().len()];
    batch.backward(&net, &x, &d_outputs, &mut gradient);
    assert_close("gradients", &gradient, mlp(&case["gradients"]).params(), 2e-6);

    let largest_norm = case["largest_norm"].as_f64().map(|n| n as f32);
    let mut adam = Adam::new(net.params().len(), AdamOptions { largest_norm, ..AdamOptions::default() });
    for _ in 0..case["steps"].as_u64().unwrap() {
        mlp_loss(case, batch.forward(&net, &x), &mut d_outputs);
        batch.backward(&net, &x, &d_outputs, &mut gradient);
        let norm = adam.step(net.params_mut(), &gradient, case["learning_rate"].as_f64().unwrap() as f32);
        assert!(
            largest_norm.is_none_or(|largest| norm.unwrap() > largest),
            "the clip must bite to be tested"
        );
    }
    assert_close("after Adam", net.params(), mlp(&case["after_adam"]).params(), 1e-5);
}

#[test]
fn plain_mlp_with_mean_squared_error() {
    check_mlp(&record()["mlp"][0]);
}

#[test]
fn dueling_mlp_with_huber_loss() {
    check_mlp(&record()["mlp"][1]);
}

#[test]
fn dueling_mlp_with_clipped_gradient() {
    check_mlp(&record()["mlp"][2]);
}

fn lstm_loss(case: &Value, outputs: &[f32], sequence: usize, weight: f32, gradient: &mut [f32]) -> f32 {
    let truth = case["truth"][sequence].as_u64().unwrap() as usize;
    if case["loss_name"] == "cross_entropy" {
        return loss::cross_entropy(outputs, truth, weight, gradient);
    }
    let goals: Vec<[f32; 2]> = numbers(&case["goals"]).chunks_exact(2).map(|g| [g[0], g[1]]).collect();
    goal_head::cross_entropy(outputs, &goals, truth, weight, gradient)
}

fn check_lstm(case: &Value) {
    let net = Lstm::load(&tensors(&case["weights"]), "").unwrap();
    let shape = net.shape();
    let lengths: Vec<usize> =
        case["lengths"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap() as usize).collect();
    let longest = *lengths.iter().max().unwrap();
    let x = numbers(&case["x"]);
    let input =
        |sequence: usize, tick: usize| &x[(sequence * longest + tick) * shape.input()..][..shape.input()];

    let mut batch = LstmBatch::new(shape, lengths.len(), longest);
    batch.begin(&lengths);
    for (sequence, &length) in lengths.iter().enumerate() {
        (0..length).for_each(|t| batch.input_mut(sequence, t).copy_from_slice(input(sequence, t)));
    }
    batch.forward(&net);
    let weight = 1.0 / batch.total_ticks() as f32;
    let mut value = 0.0;
    for (sequence, &length) in lengths.iter().enumerate() {
        let mut state = LstmState::new(shape);
        let expected = numbers(&case["outputs"][sequence]);
        for (tick, expected) in (0..length).zip(expected.chunks_exact(shape.output())) {
            assert_close("step", net.step(input(sequence, tick), &mut state), expected, 2e-6);
            let (outputs, gradient) = batch.output_and_gradient_mut(sequence, tick);
            assert_close("batch", outputs, expected, 2e-6);
            value += weight * lstm_loss(case, outputs, sequence, weight, gradient);
        }
    }
    assert_close("loss", &[value], &[case["loss"].as_f64().unwrap() as f32], 2e-6);
    let mut gradient = vec![0.0; net.params().len()];
    batch.backward(&net, &mut gradient);
    let expected = Lstm::load(&tensors(&case["gradients"]), "").unwrap();
    assert_close("gradients", &gradient, expected.params(), 2e-6);
}

#[test]
fn lstm_with_cross_entropy() {
    check_lstm(&record()["lstm"][0]);
}

#[test]
fn lstm_with_the_calibrated_head() {
    check_lstm(&record()["lstm"][1]);
}

#[test]
fn weights_that_pytorch_saved_run_here() {
    let file = TensorFile::from_bytes(include_bytes!("data/pytorch.safetensors")).unwrap();
    let net = Mlp::load(&file, "").unwrap();
    let list = |key| -> Vec<f32> { serde_json::from_str(file.get(key).unwrap()).unwrap() };
    let (x, outputs) = (list("x"), list("outputs"));
    let mut scratch = MlpScratch::new(net.shape());
    for (x, expected) in x.chunks_exact(4).zip(outputs.chunks_exact(3)) {
        assert_close("outputs", net.forward(x, &mut scratch), expected, 2e-6);
    }
}
