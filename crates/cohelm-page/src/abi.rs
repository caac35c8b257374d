//! The page as C functions: numbers in and out, bytes through two buffers.
//!
//! Bytes go in through a buffer of this module: [`cohelm_input`] makes room and says where, the page writes, and the
//! next call uses them up. Bytes come out through another: a function returns how many there are,
//! and [`cohelm_output`] says where they lie until the next call. A negative number is an error, whose message lies in
//! the output buffer, −n bytes of UTF-8. (After any call that may have allocated, JavaScript must look at
//! `memory.buffer` afresh: growing the memory detaches the old one.)
//!
//! | function | bytes in | bytes out |
//! |---|---|---|
//! | [`cohelm_about`] | | JSON: hash of the sources, plants with their versions |
//! | [`cohelm_model`] | a model's file | JSON: [`ModelReport`](crate::answers::ModelReport) |
//! | [`cohelm_begin`] | JSON: a setup | JSON: [`Opening`](cohelm::report::Opening) |
//! | [`cohelm_key`], [`cohelm_stick`] | | |
//! | [`cohelm_tick`] | | JSON: [`TickReport`](cohelm::report::TickReport); none once the episode has ended |
//! | [`cohelm_events`] | | key events, as [`put_event`](cohelm::trajectory::put_event) writes them |
//! | [`cohelm_digests`] | | JSON: [`DigestReport`](crate::answers::DigestReport) |
//! | [`cohelm_finish`] | | the trajectory |
//! | [`cohelm_watch`] | a trajectory | JSON: [`Opening`](cohelm::report::Opening) |
//! | [`cohelm_seek`] | | JSON: [`TickReport`](cohelm::report::TickReport); none at the beginning |
//! | [`cohelm_branch`] | JSON: a [`Wish`](crate::branching::Wish) | JSON: [`Opening`](cohelm::report::Opening) at the branching tick |
//! | [`cohelm_pilots`] | | JSON: a list of [`Hands`](crate::branching::Hands) |
//! | [`cohelm_replay`] | a trajectory | JSON: [`ReplayReport`](crate::answers::ReplayReport) |
//! | [`cohelm_panic`] | | the message of the panic that stopped this instance, if one did |
//!
//! No pointer from outside is ever followed: lengths are checked against the buffer that is this module's own. The
//! only unsafe thing here is that the functions' names are not mangled. A panic is a bug; it stops the instance, and the
//! page must load another.
#![allow(unsafe_code, reason = "an exported name is an unsafe attribute; there is no unsafe block")]

use crate::SOURCE_HASH;
use crate::page::{Page, PageError};
use cohelm::keys::Change;
use cohelm::registry::{OfferedActions, PlantEntry};
use serde::Serialize;
use std::cell::RefCell;

/// Most bytes that are taken in at once: the longest record that the server stores, which is several times the largest
/// model.
pub const MAX_INPUT: usize = cohelm::trajectory::MAX_BYTES;

thread_local! {
    static PAGE: RefCell<Page> = RefCell::new(Page::new());
    static INPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Makes room for `length` bytes of input and says where; null if that is more than [`MAX_INPUT`].
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_input(length: usize) -> *mut u8 {
    if length > MAX_INPUT {
        return std::ptr::null_mut();
    }
    INPUT.with_borrow_mut(|input| {
        input.clear();
        input.resize(length, 0);
        input.as_mut_ptr()
    })
}

/// Where the bytes of the last answer lie, until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_output() -> *const u8 {
    OUTPUT.with_borrow(|output| output.as_ptr())
}

/// What this build is.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_about() -> i32 {
    remember_panics();
    answer(|page, _| json(&about(page)))
}

/// Takes in the model whose file is in the input.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_model() -> i32 {
    remember_panics();
    answer(|page, input| json(&page.add_model(input)?))
}

/// Begins the flight of the setup in the input.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_begin() -> i32 {
    remember_panics();
    answer(|page, input| json(&page.begin(input)?))
}

/// A control was pressed (`kind` 0) or released (1), or all are to be released (2); `at_ms` by the page's clock since the
/// episode began. Other kinds and controls that do not exist change nothing.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_key(kind: u32, control: u32, at_ms: f32) -> i32 {
    let Ok(control) = u8::try_from(control) else { return 0 };
    let change = match kind {
        0 => Change::Down(control),
        1 => Change::Up(control),
        2 => Change::ReleaseAll,
        _ => return 0,
    };
    answer(|page, _| page.change(change, at_ms).map(|()| Vec::new()))
}

/// The stick moved to these axes, each in −32767..=32767 (values beyond are cut).
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_stick(x: i32, y: i32, z: i32, w: i32, at_ms: f32) -> i32 {
    let axes = [x, y, z, w].map(|axis| axis.clamp(-32767, 32767) as i16);
    answer(|page, _| page.change(Change::Stick(axes), at_ms).map(|()| Vec::new()))
}

/// Flies one tick.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_tick() -> i32 {
    answer(|page, _| page.tick()?.map_or(Ok(Vec::new()), |report| json(&report)))
}

/// The key log from the event of that index on.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_events(from: u32) -> i32 {
    answer(|page, _| page.events_from(from as usize))
}

/// Digests of all bits so far.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_digests() -> i32 {
    answer(|page, _| json(&page.digests()?))
}

/// Ends the flight and gives its record.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_finish() -> i32 {
    answer(|page, _| page.finish())
}

/// Shows the record in the input.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_watch() -> i32 {
    remember_panics();
    answer(|page, input| json(&page.watch(input)?))
}

/// Goes to where the record stands after that many ticks.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_seek(ticks: u32) -> i32 {
    answer(|page, _| page.seek(ticks)?.map_or(Ok(Vec::new()), |report| json(&report)))
}

/// Flies the record that is watched on as the wish in the input says.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_branch() -> i32 {
    answer(|page, input| json(&page.branch(input)?))
}

/// Who can take over the record that is watched.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_pilots() -> i32 {
    answer(|page, _| json(&page.pilots()?))
}

/// Flies the record in the input again and compares.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_replay() -> i32 {
    remember_panics();
    answer(|page, input| json(&page.replay(input)?))
}

/// The message of the panic that stopped this instance. It may be asked for after the trap, unlike anything else.
#[unsafe(no_mangle)]
pub extern "C" fn cohelm_panic() -> i32 {
    put(Ok(PANIC.with_borrow(|message| message.as_bytes().to_vec())))
}

#[derive(Serialize)]
struct About {
    source_hash: &'static str,
    version: &'static str,
    plants: Vec<AboutPlant>,
}

#[derive(Serialize)]
struct AboutPlant {
    name: &'static str,
    version: u32,
    summary: &'static str,
    /// The sets of actions to choose from, the usual one first.
    actions: Vec<AboutActions>,
}

#[derive(Serialize)]
struct AboutActions {
    name: &'static str,
    label: &'static str,
    options: serde_json::Value,
}

fn about(page: &Page) -> About {
    let actions =
        |set: &OfferedActions| AboutActions { name: set.name, label: set.label, options: set.options() };
    let plant = |entry: &PlantEntry| AboutPlant {
        name: entry.name,
        version: entry.version,
        summary: entry.summary,
        actions: entry.actions.iter().map(actions).collect(),
    };
    About {
        source_hash: SOURCE_HASH,
        version: env!("CARGO_PKG_VERSION"),
        plants: page.plants().iter().map(plant).collect(),
    }
}

fn json(value: &impl Serialize) -> Result<Vec<u8>, PageError> {
    serde_json::to_vec(value).map_err(PageError::Answer)
}

/// Lets `work` use page and input, puts what it gives into the output and says how much that is. The input is used up.
fn answer(work: impl FnOnce(&mut Page, &[u8]) -> Result<Vec<u8>, PageError>) -> i32 {
    let input = INPUT.take();
    put(PAGE.with_borrow_mut(|page| work(page, &input)))
}

fn put(given: Result<Vec<u8>, PageError>) -> i32 {
    let (bytes, sign) = match given {
        Ok(bytes) => (bytes, 1),
        Err(error) => (error.to_string().into_bytes(), -1),
    };
    let length = i32::try_from(bytes.len()).unwrap_or(i32::MAX);
    OUTPUT.set(bytes);
    sign * length
}

/// Keeps the message of a panic, which otherwise would be lost: a page has no standard error.
fn remember_panics() {
    if cfg!(target_family = "wasm") {
        std::panic::set_hook(Box::new(|panic| PANIC.with_borrow_mut(|message| *message = panic.to_string())));
    }
}
