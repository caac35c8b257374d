//! The control loop's forward pass allocates nothing, counted by the allocator itself.
#![allow(unsafe_code, reason = "a counting allocator cannot be written without")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use cohelm_nn::goal_head;
use cohelm_nn::lstm::{Lstm, LstmShape, LstmState};
use cohelm_nn::mlp::{Head, Mlp, MlpScratch, MlpShape};

struct Counting;

thread_local! {
    // Other threads (the test harness) may allocate whenever they like.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: everything is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn allocations_of(what: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.with(Cell::get);
    what();
    ALLOCATIONS.with(Cell::get) - before
}

#[test]
fn the_counter_counts() {
    assert!(allocations_of(|| drop(std::hint::black_box(vec![0u8; 100]))) > 0);
}

#[test]
fn a_hundred_decisions_allocate_nothing() {
    let intent = Lstm::zeros(LstmShape::new(26, 64, goal_head::OUTPUTS).unwrap());
    let values = Mlp::zeros(&MlpShape::new(13, &[64, 64], Head::Dueling(4)).unwrap());
    let mut state = LstmState::new(intent.shape());
    let mut scratch = MlpScratch::new(values.shape());
    let goals = [[-0.5, 0.1], [0.25, 0.0], [0.75, -0.2]];
    let mut probabilities = [0.0; 3];
    let count = allocations_of(|| {
        state.reset();
        for _ in 0..100 {
            let outputs = intent.step(&[0.5; 26], &mut state);
            goal_head::probabilities(outputs, &goals, &mut probabilities);
            std::hint::black_box(values.forward(&[0.5; 13], &mut scratch));
        }
    });
    assert_eq!(count, 0);
}

#[cfg(feature = "train")]
mod training {
    use super::*;
    use cohelm_nn::adam::{Adam, AdamOptions, follow};
    use cohelm_nn::lstm::LstmBatch;
    use cohelm_nn::mlp::MlpBatch;

    const CLIPPED: AdamOptions =
        AdamOptions { beta1: 0.9, beta2: 0.999, epsilon: 1e-8, largest_norm: Some(1.0) };

    #[test]
    fn ten_steps_of_an_mlp_allocate_nothing() {
        let shape = MlpShape::new(13, &[64, 64], Head::Dueling(4)).unwrap();
        let (mut net, mut target) = (Mlp::zeros(&shape), Mlp::zeros(&shape));
        let mut batch = MlpBatch::new(&shape, 32);
        let mut adam = Adam::new(shape.parameters(), CLIPPED);
        let (x, d, mut gradient) = (vec![0.5; 32 * 13], vec![0.1; 32 * 4], vec![0.0; shape.parameters()]);
        let count = allocations_of(|| {
            for _ in 0..10 {
                batch.forward(&net, &x);
                batch.backward(&net, &x, &d, &mut gradient);
                adam.step(net.params_mut(), &gradient, 1e-3);
                follow(target.params_mut(), net.params(), 0.005);
            }
        });
        assert_eq!(count, 0);
    }

    #[test]
    fn nine_steps_of_an_lstm_allocate_nothing() {
        let shape = LstmShape::new(5, 16, 3).unwrap();
        let mut net = Lstm::zeros(shape);
        let mut batch = LstmBatch::new(shape, 4, 9);
        let mut adam = Adam::new(shape.parameters(), CLIPPED);
        let mut gradient = vec![0.0; shape.parameters()];
        let count = allocations_of(|| {
            for longest in 0..9 {
                batch.begin(&[longest, 1, longest / 2]);
                batch.input_mut(1, 0).fill(0.5);
                batch.forward(&net);
                batch.output_and_gradient_mut(1, 0).1.fill(0.1);
                batch.backward(&net, &mut gradient);
                adam.step(net.params_mut(), &gradient, 1e-3);
            }
        });
        assert_eq!(count, 0);
    }
}
