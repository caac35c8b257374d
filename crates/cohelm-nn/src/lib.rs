//! Three small networks, an [`Mlp`](mlp::Mlp), a [`Critic`](critic::Critic) and an [`Lstm`](lstm::Lstm), trained here and
//! run here.
//!
//! The same weights have two forward passes. Training's ([`mlp::MlpBatch`], [`lstm::LstmBatch`]) works on
//! whole batches with the widest vectors that the CPU has. The control loop's ([`mlp::Mlp::forward`],
//! [`critic::Critic::values`], [`lstm::Lstm::step`]) takes one observation, allocates nothing, cannot fail, and gives the same bits on
//! every CPU and in WebAssembly ([`fingerprint::control_loop`] is how two builds compare). The two agree to
//! about 1e-6, not to the bit.
//!
//! Gradients are written by hand for exactly these three networks, and held against finite differences and
//! against numbers recorded from PyTorch. The crate knows no plant, no file, and no clock but in [`mod@bench`]; it
//! draws no random number (callers hand in a source) and starts no thread. Workspaces belong to one thread
//! each, and a trainer that gives chunk i of a batch to any thread and adds up the gradients in the order of
//! the chunks ([`adam::add_in_order`]) gets the same weights from any number of threads.
//!
//! Without the default feature `train` only what a page needs is left: the control loop's passes, the portable
//! functions, [`goal_head::probabilities`] and [`weights`].
//!
//! ```
//! # #[cfg(feature = "train")] {
//! use cohelm_nn::adam::{Adam, AdamOptions};
//! use cohelm_nn::mlp::{Head, Mlp, MlpBatch, MlpScratch, MlpShape};
//! use cohelm_nn::weights::TensorFile;
//!
//! // A source of uniform numbers; a program has a seeded generator.
//! let mut state = 1u32;
//! let mut uniform = move || {
//!     state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
//!     (state >> 8) as f32 / (1 << 24) as f32
//! };
//!
//! // Learn the sine from 64 points.
//! let shape = MlpShape::new(1, &[32, 32], Head::Plain(1))?;
//! let mut net = Mlp::new(&shape, &mut uniform);
//! let mut batch = MlpBatch::new(&shape, 64);
//! let mut adam = Adam::new(shape.parameters(), AdamOptions::default());
//! let x: Vec<f32> = (0..64).map(|i| i as f32 / 10.0 - 3.2).collect();
//! let mut gradient = vec![0.0; shape.parameters()];
//! for _ in 0..800 {
//!     let y = batch.forward(&net, &x);
//!     let error: Vec<f32> = y.iter().zip(&x).map(|(y, x)| (y - x.sin()) / 64.0).collect();
//!     batch.backward(&net, &x, &error, &mut gradient);
//!     adam.step(net.params_mut(), &gradient, 3e-3);
//! }
//!
//! // Save it, read it again, and ask it one value as the control loop does.
//! let mut file = TensorFile::new();
//! net.save(&mut file, "");
//! let same = Mlp::load(&TensorFile::from_bytes(&file.to_bytes()?)?, "")?;
//! let mut scratch = MlpScratch::new(same.shape());
//! assert!((same.forward(&[1.0], &mut scratch)[0] - 1.0f32.sin()).abs() < 0.05);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod critic;
mod dense;
pub mod fingerprint;
pub mod goal_head;
mod init;
pub mod lstm;
pub mod math;
pub mod mlp;
pub mod shape;
pub mod weights;

#[cfg(feature = "train")]
pub mod adam;
#[cfg(feature = "train")]
pub mod bench;
#[cfg(feature = "train")]
mod dense_batch;
#[cfg(feature = "train")]
mod gemm;
#[cfg(feature = "train")]
pub mod loss;

#[cfg(feature = "train")]
pub use gemm::kernel_name;
