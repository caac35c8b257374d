//! Human alone (HIC). Formula: a = a_h. Source: the paper's baseline, Section IV. What is asked is carried out; with
//! nothing asked nothing changes. It has no extremes.

use super::{Arbiter, Pick, Stage};

/// The person flies (HIC): what is asked is carried out; with no input nothing changes.
#[derive(Clone, Copy, Debug)]
pub struct HumanAlone;

impl Arbiter for HumanAlone {
    fn decide(&self, stage: &Stage<'_>, allowed: &mut [bool]) -> Pick {
        allowed.fill(true);
        if stage.likeness.is_some() { Pick::Asked } else { Pick::Nothing }
    }
}
