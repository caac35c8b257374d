//! How well intent is inferred: right goals, confidence, and whether probabilities are true ones, against time.

use crate::sequence::Sequence;
use cohelm::intent::{Belief, Head};
use cohelm::plant::Goal;
use cohelm_copilot::encode::INTENT_TICKS;
use cohelm_copilot::model::IntentNetworks;
use cohelm_nn::goal_head::LN_SIGMA_MOST;
use cohelm_nn::lstm::LstmState;
use cohelm_nn::math::exp;
use serde::Serialize;

/// Times since the start, in control ticks, at which the rows of the table begin.
const SINCE: [u32; 7] = [0, 25, 50, 75, 100, 150, 250];
/// Bins of the calibration error.
const BINS: usize = 10;

/// Scores of one head over one span of time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct IntentScore {
    /// First control tick of the span.
    pub from: u32,
    /// First control tick after it; `None` for the last span and for the whole flight.
    pub to: Option<u32>,
    /// Ticks of the network that were scored.
    pub ticks: usize,
    /// Share of them at which the likeliest goal was the pilot's.
    pub accuracy: f64,
    /// Mean c.
    pub confidence: f64,
    /// Expected calibration error: mean difference between the probability given to the likeliest goal and how often
    /// that goal is right, over ten bins of that probability, weighted by ticks.
    pub calibration_error: f64,
    /// Mean −ln p of the pilot's goal.
    pub surprise: f64,
}

/// Scores of one head: over the whole flight, and against time since the start.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeadScores {
    /// Which head.
    pub head: Head,
    /// Over all ticks.
    pub all: IntentScore,
    /// Span by span.
    pub by_time: Vec<IntentScore>,
}

/// What was believed at one tick of the network.
#[derive(Clone, Copy)]
struct Believed {
    tick: u32,
    belief: Belief,
    truth: usize,
}

/// Scores one head on flights.
pub(crate) fn score(networks: &IntentNetworks, head: Head, sequences: &[&Sequence]) -> HeadScores {
    let believed: Vec<Believed> =
        sequences.iter().flat_map(|sequence| beliefs(networks, head, sequence)).collect();
    let span = |from: u32, to: Option<u32>| {
        let within = |b: &&Believed| b.tick >= from && to.is_none_or(|to| b.tick < to);
        let chosen: Vec<&Believed> = believed.iter().filter(within).collect();
        summary(from, to, &chosen)
    };
    let ends = SINCE.iter().skip(1).copied().map(Some).chain([None]);
    HeadScores {
        head,
        all: span(0, None),
        by_time: SINCE.into_iter().zip(ends).map(|(a, b)| span(a, b)).collect(),
    }
}

fn beliefs(networks: &IntentNetworks, head: Head, sequence: &Sequence) -> Vec<Believed> {
    let network = match head {
        Head::InverseDistance | Head::Softmax => &networks.regression,
        Head::Calibrated => &networks.calibrated,
    };
    let mut state = LstmState::new(network.shape());
    let mut at = |tick: usize| {
        let outputs = network.step(&sequence.row(tick)[..network.shape().input()], &mut state);
        let spread = outputs.get(2).map_or(1.0, |&ln| exp(ln.clamp(-LN_SIGMA_MOST, LN_SIGMA_MOST)));
        let goals: Vec<Goal> =
            sequence.goals(tick).iter().map(|&position| Goal { id: 0, position }).collect();
        let belief = head.belief(&goals, [outputs[0], outputs[1]], spread);
        Believed { tick: (tick as u32 + 1) * INTENT_TICKS, belief, truth: sequence.truth(tick) }
    };
    (0..sequence.ticks()).map(&mut at).collect()
}

fn summary(from: u32, to: Option<u32>, believed: &[&Believed]) -> IntentScore {
    let ticks = believed.len();
    let mean =
        |of: &dyn Fn(&Believed) -> f64| believed.iter().map(|b| of(b)).sum::<f64>() / ticks.max(1) as f64;
    let right = |b: &Believed| f64::from(u8::from(b.belief.goal == b.truth));
    let of_truth = |b: &Believed| f64::from(b.belief.probabilities().get(b.truth).copied().unwrap_or(0.0));
    let mut bins = [(0.0, 0.0); BINS];
    for b in believed {
        let p = f64::from(b.belief.probabilities().get(b.belief.goal).copied().unwrap_or(0.0));
        let bin = &mut bins[((p * BINS as f64) as usize).min(BINS - 1)];
        *bin = (bin.0 + p, bin.1 + right(b));
    }
    IntentScore {
        from,
        to,
        ticks,
        accuracy: mean(&right),
        confidence: mean(&|b| f64::from(b.belief.confidence)),
        calibration_error: bins.iter().map(|(p, right)| (p - right).abs()).sum::<f64>() / ticks.max(1) as f64,
        surprise: mean(&|b| -of_truth(b).max(1e-9).ln()),
    }
}
