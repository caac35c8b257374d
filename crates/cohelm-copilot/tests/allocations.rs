//! A tick with both networks allocates nothing.
#![allow(unsafe_code, reason = "counting allocations takes an allocator of one's own")]

mod made;

use cohelm::arbitration::Rule;
use cohelm::cockpit::Silence;
use cohelm::intent::Inference;
use cohelm::pilot::Recorded;
use cohelm::trajectory::Setup;
use cohelm_copilot::{Models, cockpit};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: everything is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations in a hundred ticks after the first ten, with or without a co-pilot.
fn allocations(rule: Rule, inference: Inference, models: &Models) -> u64 {
    let assisted = rule != Rule::Hic;
    let hash = |i| models.iter().nth(i).filter(|_| assisted).map(|model| model.hash().to_owned());
    let of_intent = if inference.hides_goals() { 2 } else { 1 };
    let setup = Setup {
        task: made::task(),
        plant_version: made::plants().entry(&made::task()).unwrap().version,
        seed: 2,
        rule,
        inference,
        silence: Silence::Best,
        time_scale: 1.0,
        values: hash(0),
        intent: hash(of_intent),
        pilot: "test".into(),
    };
    let mut plant = made::plants().make(&setup.task).unwrap();
    plant.reset(2);
    let mut cockpit = cockpit(&setup, plant.as_ref(), &made::plants(), models).unwrap();
    cockpit.begin();
    let asked = [Some(cohelm::action::Action::Command(2)); 110];
    let mut pilot = Recorded::new(&asked);
    let mut counted = 0;
    for tick in 0..50 {
        let before = COUNT.with(Cell::get);
        cockpit.tick(plant.as_mut(), &mut pilot);
        counted += if tick < 10 { 0 } else { COUNT.with(Cell::get) - before };
    }
    counted
}

#[test]
fn a_tick_with_both_networks_allocates_no_more_than_the_plant_does() {
    let mut models = Models::new();
    models.add_model(made::values(3));
    models.add_model(made::intent(4));
    models.add_model(made::imagining(5));
    let of_plant = allocations(Rule::Hic, Inference::Nearest, &models);
    for inference in Inference::ALL {
        for rule in [Rule::Lasc, Rule::Misc, Rule::MiscR { kappa: 0.7 }] {
            assert_eq!(allocations(rule, inference, &models), of_plant, "{rule:?} {inference:?}");
        }
    }
}
