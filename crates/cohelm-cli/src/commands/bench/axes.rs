//! How long the values of a decision on axes take.

use anyhow::{Context, Result};
use cohelm::action::{Action, ActionSpace};
use cohelm_copilot::search::{CANDIDATES, Search};
use cohelm_nn::bench::{Timing, decision as time};
use cohelm_nn::critic::Critic;
use std::hint::black_box;

/// Numbers of the lander's state and the way to its goal.
const INPUTS: usize = 13;

/// All candidates of a decision on two axes, with a critic of the shipped size; what is asked differs from one decision to the
/// next.
pub fn decision(runs: usize) -> Result<Timing> {
    const NAME: &str = "decision on two axes: values of 128 candidates";
    const _: () = assert!(CANDIDATES == 128);
    let names = vec!["main".into(), "side".into()];
    let space = ActionSpace::Axes { names, low: vec![-1.0; 2], high: vec![1.0; 2] };
    let shape = Search::shape(&space, INPUTS, &[64, 64]).context("these widths make a critic")?;
    let mut number = 1_u32;
    let mut uniform = || {
        number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (number >> 8) as f32 / (1 << 24) as f32
    };
    let critic = Critic::new(&shape, &mut uniform);
    let mut search = Search::new(&space, &critic).context("two axes can be searched")?;
    let input: Vec<f32> = (0..INPUTS).map(|_| 2.0 * uniform() - 1.0).collect();
    Ok(time(NAME, runs, || {
        let asked = Action::axes(&[2.0 * uniform() - 1.0, 2.0 * uniform() - 1.0]);
        black_box(search.estimate(&critic, black_box(&input), Some(asked)).best());
    }))
}
