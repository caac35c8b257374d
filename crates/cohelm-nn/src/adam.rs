//! Adam (Kingma & Ba 2015, Algorithm 1) on flat parameters, as PyTorch's `optim.Adam` computes it.

use crate::gemm::vectorised;

/// Constants of Adam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdamOptions {
    /// Decay of the mean gradient, a step. Usual 0.9; nearer to 1 is smoother and slower to turn.
    pub beta1: f32,
    /// Decay of the mean squared gradient, a step. Usual 0.999; too low makes single gradients shake the scale.
    pub beta2: f32,
    /// Added to the root of the mean squared gradient. Usual 1e-8; larger damps parameters with tiny gradients.
    pub epsilon: f32,
    /// Largest Euclidean norm of the whole gradient, which is scaled down to it; none by default. Usual 1 to
    /// 10: too low turns every step into one of fixed length.
    pub largest_norm: Option<f32>,
}

impl Default for AdamOptions {
    fn default() -> Self {
        Self { beta1: 0.9, beta2: 0.999, epsilon: 1e-8, largest_norm: None }
    }
}

/// The optimiser and its state, aligned with a network's flat parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Adam {
    options: AdamOptions,
    steps: u64,
    mean: Vec<f32>,
    mean_square: Vec<f32>,
}

impl Adam {
    /// An optimiser for this many parameters, no step done.
    #[must_use]
    pub fn new(parameters: usize, options: AdamOptions) -> Self {
        Self { options, steps: 0, mean: vec![0.0; parameters], mean_square: vec![0.0; parameters] }
    }

    /// The state as it was saved; the two moments have equal lengths.
    pub(crate) fn restore(options: AdamOptions, steps: u64, mean: Vec<f32>, mean_square: Vec<f32>) -> Self {
        debug_assert_eq!(mean.len(), mean_square.len());
        Self { options, steps, mean, mean_square }
    }

    /// The constants.
    #[must_use]
    pub fn options(&self) -> AdamOptions {
        self.options
    }

    /// Steps done.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Decaying means of the gradient and of its square, aligned with the parameters.
    #[must_use]
    pub fn moments(&self) -> (&[f32], &[f32]) {
        (&self.mean, &self.mean_square)
    }

    /// One step down `gradient` with the given learning rate; returns the gradient's norm before clipping.
    ///
    /// The norm is computed only where [`AdamOptions::largest_norm`] asks for it, otherwise it is `None`.
    ///
    /// # Panics
    /// If the slices are not as long as the optimiser was made for.
    pub fn step(&mut self, params: &mut [f32], gradient: &[f32], learning_rate: f32) -> Option<f32> {
        let (scale, norm) = self.clip(gradient);
        self.advance(params, gradient, scale, learning_rate);
        norm
    }

    /// What to multiply the gradient by, as `torch.nn.utils.clip_grad_norm_` does, and its norm.
    fn clip(&self, gradient: &[f32]) -> (f32, Option<f32>) {
        match self.options.largest_norm {
            None => (1.0, None),
            Some(largest) => {
                let norm = norm(gradient);
                ((largest / (norm + 1e-6)).min(1.0), Some(norm))
            }
        }
    }

    fn advance(&mut self, params: &mut [f32], gradient: &[f32], scale: f32, learning_rate: f32) {
        let n = params.len();
        assert!(
            n == gradient.len() && n == self.mean.len(),
            "an optimiser for {} parameters",
            self.mean.len()
        );
        self.steps += 1;
        let AdamOptions { beta1, beta2, epsilon, .. } = self.options;
        let step_size = (f64::from(learning_rate) / self.correction(beta1)) as f32;
        let scale_root = (1.0 / self.correction(beta2).sqrt()) as f32;
        let (mean, mean_square) = (&mut self.mean[..], &mut self.mean_square[..]);
        vectorised(|| {
            let moments = mean.iter_mut().zip(mean_square);
            for ((p, g), (m, v)) in params.iter_mut().zip(gradient).zip(moments) {
                let g = g * scale;
                *m += (g - *m) * (1.0 - beta1);
                *v = *v * beta2 + g * g * (1.0 - beta2);
                *p -= step_size * *m / (v.sqrt() * scale_root + epsilon);
            }
        });
    }

    /// 1 − βᵗ, the part of a mean over t steps that is filled.
    fn correction(&self, beta: f32) -> f64 {
        1.0 - libm::pow(f64::from(beta), self.steps as f64)
    }
}

/// Euclidean norm, summed in eight fixed lanes so that it is quick and the same for any vector width.
#[must_use]
pub fn norm(gradient: &[f32]) -> f32 {
    let mut lanes = [0.0f32; 8];
    let chunks = gradient.chunks_exact(8);
    let rest: f32 = chunks.remainder().iter().map(|g| g * g).sum();
    for chunk in chunks {
        for (lane, g) in lanes.iter_mut().zip(chunk) {
            *lane += g * g;
        }
    }
    (lanes.iter().sum::<f32>() + rest).sqrt()
}

/// sum += gradient. Called for chunk after chunk in their order, the result is the same however many threads
/// computed them.
///
/// # Panics
/// If the lengths differ.
pub fn add_in_order(sum: &mut [f32], gradient: &[f32]) {
    assert_eq!(sum.len(), gradient.len());
    vectorised(|| {
        for (s, g) in sum.iter_mut().zip(gradient) {
            *s += g;
        }
    });
}

/// Moves a target network's parameters towards the online ones: target += rate·(online − target).
///
/// `rate` 1 copies; 0.005 at every update is usual in double DQN. Too high makes the target follow its own
/// errors, too low makes it old.
///
/// # Panics
/// If the lengths differ.
pub fn follow(target: &mut [f32], online: &[f32], rate: f32) {
    assert_eq!(target.len(), online.len());
    if rate == 1.0 {
        target.copy_from_slice(online);
        return;
    }
    vectorised(|| {
        for (t, o) in target.iter_mut().zip(online) {
            *t += rate * (o - *t);
        }
    });
}
