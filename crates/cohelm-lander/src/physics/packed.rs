//! Several worlds' numbers in vector registers: safe SIMD by crate `pulp`.
//!
//! `V` registers of numbers side by side go through every operation, so that one register's result is computed while another's
//! is waited for: the solver is one long chain of dependent operations. Additions, multiplications and comparisons round alike
//! on every instruction set, and nothing is fused.

use std::ops::{Add, Mul, Neg, Sub};

use pulp::Simd;

use super::lanes::Lanes;

/// Most lanes that any instruction set gives.
pub(crate) const MOST_LANES: usize = 32;

/// `V` registers of instruction set `S`, in memory aligned so that none straddles two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Packed<S: Simd, const V: usize> {
    simd: S,
    registers: [S::f32s; V],
}

/// One truth value a lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PackedMask<S: Simd, const V: usize> {
    simd: S,
    registers: [S::m32s; V],
}

impl<S: Simd, const V: usize> Packed<S, V> {
    /// How many worlds lie side by side.
    pub const LANES: usize = V * S::F32_LANES;

    /// A number of each world. Lanes without a world repeat the last one's, so that they compute nothing unusual.
    #[inline(always)]
    pub fn gather<T>(simd: S, worlds: &[T], number: impl Fn(&T) -> f32) -> Self {
        let mut lanes = [0.0; MOST_LANES];
        for (lane, world) in lanes.iter_mut().zip(worlds) {
            *lane = number(world);
        }
        let last = lanes[worlds.len() - 1];
        lanes[worlds.len()..].fill(last);
        Self::load(simd, &lanes)
    }

    /// The numbers of all lanes; beyond [`Packed::LANES`] they mean nothing.
    #[inline(always)]
    pub fn lanes(self) -> [f32; MOST_LANES] {
        let mut lanes = [0.0; MOST_LANES];
        let (registers, _) = S::as_mut_simd_f32s(&mut lanes);
        registers[..V].copy_from_slice(&self.registers);
        lanes
    }

    #[inline(always)]
    fn load(simd: S, lanes: &[f32; MOST_LANES]) -> Self {
        let (all, _) = S::as_simd_f32s(lanes);
        let mut registers = [simd.splat_f32s(0.0); V];
        registers.copy_from_slice(&all[..V]);
        Packed { simd, registers }
    }

    #[inline(always)]
    fn each(mut self, op: impl Fn(S::f32s) -> S::f32s) -> Self {
        for register in &mut self.registers {
            *register = op(*register);
        }
        self
    }

    #[inline(always)]
    fn with(mut self, other: Self, op: impl Fn(S::f32s, S::f32s) -> S::f32s) -> Self {
        for (register, other) in self.registers.iter_mut().zip(other.registers) {
            *register = op(*register, other);
        }
        self
    }

    #[inline(always)]
    fn compare(self, other: Self, op: impl Fn(S::f32s, S::f32s) -> S::m32s) -> PackedMask<S, V> {
        let mut registers = [op(self.registers[0], other.registers[0]); V];
        for (register, (a, b)) in registers.iter_mut().zip(self.registers.into_iter().zip(other.registers)) {
            *register = op(a, b);
        }
        PackedMask { simd: self.simd, registers }
    }
}

impl<S: Simd, const V: usize> Lanes for Packed<S, V> {
    type Mask = PackedMask<S, V>;

    #[inline(always)]
    fn alike(self, value: f32) -> Self {
        Packed { simd: self.simd, registers: [self.simd.splat_f32s(value); V] }
    }

    #[inline(always)]
    fn less_than(self, other: Self) -> PackedMask<S, V> {
        self.compare(other, |a, b| self.simd.less_than_f32s(a, b))
    }

    #[inline(always)]
    fn equals(self, other: Self) -> PackedMask<S, V> {
        self.compare(other, |a, b| self.simd.equal_f32s(a, b))
    }

    #[inline(always)]
    fn either(mut a: PackedMask<S, V>, b: PackedMask<S, V>) -> PackedMask<S, V> {
        for (register, other) in a.registers.iter_mut().zip(b.registers) {
            *register = a.simd.or_m32s(*register, other);
        }
        a
    }

    #[inline(always)]
    fn choose(mask: PackedMask<S, V>, yes: Self, mut no: Self) -> Self {
        for i in 0..V {
            no.registers[i] = no.simd.select_f32s(mask.registers[i], yes.registers[i], no.registers[i]);
        }
        no
    }

    #[inline(always)]
    fn surely_all(_: PackedMask<S, V>) -> bool {
        false
    }

    #[inline(always)]
    fn surely_none(_: PackedMask<S, V>) -> bool {
        false
    }
}

impl<S: Simd, const V: usize> Add for Packed<S, V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| self.simd.add_f32s(a, b))
    }
}

impl<S: Simd, const V: usize> Sub for Packed<S, V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| self.simd.sub_f32s(a, b))
    }
}

impl<S: Simd, const V: usize> Mul for Packed<S, V> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| self.simd.mul_f32s(a, b))
    }
}

impl<S: Simd, const V: usize> Neg for Packed<S, V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(|a| self.simd.neg_f32s(a))
    }
}
