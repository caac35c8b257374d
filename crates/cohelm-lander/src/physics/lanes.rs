//! The numbers that the solver is written over: an `f32` of one world, or one of each of several worlds side by side.
//!
//! No operation mixes lanes, so every lane has the bits of its world alone.

use std::ops::{Add, Mul, Neg, Sub};

/// One number a lane. An `f32` has one lane.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// One truth value a lane.
    type Mask: Copy;

    /// The same number in every lane; as many lanes as `self` has.
    fn alike(self, value: f32) -> Self;

    fn less_than(self, other: Self) -> Self::Mask;

    fn equals(self, other: Self) -> Self::Mask;

    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;

    /// `yes` where true, `no` elsewhere.
    fn choose(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// True if the mask is known to be true in every lane. A branch that leaves out work pays for a single world only: where
    /// there are several, some lane mostly needs the work, and the answer is always `false`.
    fn surely_all(mask: Self::Mask) -> bool;

    /// True if the mask is known to be false in every lane; see [`Lanes::surely_all`].
    fn surely_none(mask: Self::Mask) -> bool;
}

impl Lanes for f32 {
    type Mask = bool;

    #[inline(always)]
    fn alike(self, value: f32) -> f32 {
        value
    }

    #[inline(always)]
    fn less_than(self, other: f32) -> bool {
        self < other
    }

    #[inline(always)]
    fn equals(self, other: f32) -> bool {
        self == other
    }

    #[inline(always)]
    fn either(a: bool, b: bool) -> bool {
        a || b
    }

    #[inline(always)]
    fn choose(mask: bool, yes: f32, no: f32) -> f32 {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn surely_all(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn surely_none(mask: bool) -> bool {
        !mask
    }
}
