//! Several independent numbers side by side: the same operation on each, none ever mixed with another.
//!
//! With one lane this is plain scalar arithmetic. With eight, the compiler turns each operation into one vector
//! instruction, and every lane still has the bits of the scalar computation.

use std::ops::{Add, Mul, Neg, Sub};

/// `L` numbers of `L` independent worlds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes<const L: usize>(pub [f32; L]);

/// One truth value a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mask<const L: usize>(pub [bool; L]);

impl<const L: usize> Lanes<L> {
    pub const ZERO: Lanes<L> = Lanes([0.0; L]);

    /// The same number in every lane.
    #[inline(always)]
    pub fn all(value: f32) -> Self {
        Lanes([value; L])
    }

    #[inline(always)]
    fn zip(self, other: Self, op: impl Fn(f32, f32) -> f32) -> Self {
        let mut out = self;
        for i in 0..L {
            out.0[i] = op(self.0[i], other.0[i]);
        }
        out
    }

    #[inline(always)]
    pub fn less_than(self, other: Self) -> Mask<L> {
        let mut out = Mask([false; L]);
        for i in 0..L {
            out.0[i] = self.0[i] < other.0[i];
        }
        out
    }
}

impl<const L: usize> Mask<L> {
    #[inline(always)]
    pub fn or(self, other: Self) -> Self {
        let mut out = self;
        for i in 0..L {
            out.0[i] = self.0[i] || other.0[i];
        }
        out
    }

    #[inline(always)]
    pub fn every(self) -> bool {
        self.0.iter().fold(true, |every, lane| every & lane)
    }

    #[inline(always)]
    pub fn none(self) -> bool {
        !self.0.iter().fold(false, |any, lane| any | lane)
    }

    /// `yes` where true, `no` elsewhere.
    #[inline(always)]
    pub fn choose(self, yes: Lanes<L>, no: Lanes<L>) -> Lanes<L> {
        let mut out = no;
        for i in 0..L {
            out.0[i] = if self.0[i] { yes.0[i] } else { no.0[i] };
        }
        out
    }
}

impl<const L: usize> Add for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const L: usize> Sub for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const L: usize> Mul for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<const L: usize> Neg for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.zip(self, |a, _| -a)
    }
}
