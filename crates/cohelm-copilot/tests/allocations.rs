//! A tick with both networks allocates nothing.
#![allow(unsafe_code, reason = "counting allocations takes an allocator of one's own")]

mod made;

use cohelm::action::Action;
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

/// Allocations in forty ticks after the first ten, with or without a co-pilot.
fn allocations(rule: Rule, inference: Inference, models: &Models) -> u64 {
    let task = models.iter().next().expect("models").card().task.clone();
    let plant = made::plants().make(&task).unwrap();
    let push = if plant.space().commands() > 0 { Action::Command(2) } else { Action::axes(&[1.0, 0.25]) };
    let assisted = rule != Rule::Hic;
    let hash = |i| models.iter().nth(i).filter(|_| assisted).map(|model| model.hash().to_owned());
    let of_intent = if inference.hides_goals() { 2 } else { 1 };
    let setup = Setup {
        plant_version: made::plants().entry(&task).unwrap().version,
        task,
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
    let asked = [Some(push); 110];
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
    let of_commands = [made::values(3), made::intent(4), made::imagining(5)];
    let of_axes = [made::values_on_axes(3), made::intent_on_axes(4), made::imagining_on_axes(5)];
    for of_plant_and_models in [of_commands, of_axes] {
        let mut models = Models::new();
        for model in of_plant_and_models {
            models.add_model(model);
        }
        let of_plant = allocations(Rule::Hic, Inference::Nearest, &models);
        for inference in Inference::ALL {
            // Who looks ahead copies the plant, and a copy is memory.
            let looks_ahead = |rule: &Rule| rule.arbiter(1.0).unwrap().needs().look_ahead;
            for rule in Rule::USUAL.into_iter().skip(1).filter(|rule| !looks_ahead(rule)) {
                assert_eq!(allocations(rule, inference, &models), of_plant, "{rule:?} {inference:?}");
            }
        }
    }
}
