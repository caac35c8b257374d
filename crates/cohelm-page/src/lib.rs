//! The loop for WebAssembly: what the page calls to fly, and to watch what was flown.
//!
//! Physics and co-pilot run in the page, so that a key acts at the next tick whatever the network does. One instance
//! of this module is one [`page::Page`]: it flies one flight, shows one record, or flies one on, at a time; a page that wants
//! two of these side by side instantiates it twice.
//!
//! | module | what it explains |
//! |---|---|
//! | [`page`] | everything the page can ask for, as safe Rust that is tested natively |
//! | [`fleet`] | which plants there are, and what flies an episode |
//! | [`answers`] | what else the page is told, as JSON |
//! | [`viewing`] | a record that is watched |
//! | [`branching`] | a record that is flown on from one of its ticks, under another rule or by another pilot |
//! | [`abi`] | the same as C functions: numbers in and out, bytes through two buffers |
//!
//! This crate knows no clock (the page calls [`page::Page::tick`] when a tick is due), no keyboard (controls are
//! numbers), no network, and draws nothing: the page draws [`cohelm::scene::Scene`]s and knows no plant. It makes the
//! same bits as every other build of the same sources: `tools/page-parity` flies recorded flights through the built
//! file and demands that.

pub mod abi;
pub mod answers;
pub mod branching;
pub mod fleet;
pub mod page;
pub mod viewing;

/// SHA-256 of the sources that this was built from, as `tools/source-hash` prints it; empty in builds that nobody
/// ships. `./check` compares it with the sources it finds, so that no old page is shipped with new sources.
pub const SOURCE_HASH: &str = match option_env!("COHELM_SOURCE_HASH") {
    Some(hash) => hash,
    None => "",
};
