//! Matrix products for training, c = a·b with a bias before and ReLU after it, of the small sizes that these
//! networks have.
//!
//! Matrices of a few dozen rows and columns fit the first cache level, so nothing is packed or copied: a tile
//! of c stays in vector registers while one pass over the inner dimension reads rows of b and single numbers
//! of a. `docs/networks.md` has the timings beside GEMM libraries, which are made for larger matrices.
//!
//! Every element of c is one sum over the inner dimension from first to last, each step one fused
//! multiply-add; only columns share registers. So all CPUs with fused multiply-add (x86-64 since 2013, every
//! 64-bit Arm) give the same bits whatever the width of their vectors. The rest multiplies and adds in two
//! roundings; [`kernel_name`] tells them apart. The instruction set is chosen when the program runs, by
//! crate `pulp`.

use std::ops::Range;
use std::sync::OnceLock;

use pulp::{Arch, Simd, WithSimd};

use crate::fingerprint::Fnv;

/// Inner dimension done in one pass, so that the rows of b that a pass reads stay in the cache.
const PASS: usize = 128;

/// A left factor: `rows` × `inner`, read where it lies.
#[derive(Clone, Copy)]
pub(crate) struct Left<'a> {
    data: &'a [f32],
    rows: usize,
    inner: usize,
    /// Whether it is stored as `inner` × `rows`.
    transposed: bool,
}

impl<'a> Left<'a> {
    /// Stored row after row without gaps.
    pub fn new(data: &'a [f32], rows: usize, inner: usize) -> Self {
        Self { data: &data[..rows * inner], rows, inner, transposed: false }
    }

    /// The transpose, which is the same numbers read in another order.
    pub fn transposed(self) -> Self {
        Self { rows: self.inner, inner: self.rows, transposed: !self.transposed, ..self }
    }
}

/// What surrounds a product, done while its tiles are in registers.
#[derive(Clone, Copy, Default)]
pub(crate) struct Around<'a> {
    /// Row that every sum starts with; zeros without.
    pub bias: Option<&'a [f32]>,
    /// Whether negative results become 0.
    pub relu: bool,
}

/// c = a·b with what `around` says; `b` is inner × n and `c` rows × n, both row-major without gaps.
///
/// # Panics
/// If a slice is too short for that.
pub(crate) fn multiply(a: Left, b: &[f32], n: usize, around: Around, c: &mut [f32]) {
    arch().dispatch(Multiply { product: Product { a, b: &b[..a.inner * n], n }, around, c });
}

/// Runs element-wise work with the widest instructions of this CPU. Its bits do not depend on them.
///
/// Only what is inlined into the dispatch gets those instructions: a closure of a loop or two is, longer work
/// has to be a struct whose `with_simd` says `#[inline(always)]`.
pub(crate) fn vectorised<W: WithSimd>(work: W) -> W::Output {
    arch().dispatch(work)
}

fn arch() -> Arch {
    static ARCH: OnceLock<Arch> = OnceLock::new();
    *ARCH.get_or_init(Arch::new)
}

/// Which arithmetic this CPU trains with, and a checksum of what it computes.
///
/// Machines with the same name train the same weights from the same seed. The name says whether products are
/// fused into sums; the checksum is over the bits of a few fixed matrix products.
#[must_use]
pub fn kernel_name() -> String {
    struct Fused;
    impl WithSimd for Fused {
        type Output = bool;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> bool {
            // (1 + 2⁻¹²)² needs one bit more than f32 has.
            let x = 1.0 + 1.0 / 4096.0f32;
            let rest = simd.mul_add_e_f32s(simd.splat_f32s(x), simd.splat_f32s(x), simd.splat_f32s(-(x * x)));
            simd.reduce_max_f32s(rest) != 0.0
        }
    }
    let name = if arch().dispatch(Fused) { "fused" } else { "unfused" };
    format!("{name} {:08x}", checksum())
}

/// FNV-1a over the products of a few fixed matrices, among them shapes with remainders in every direction.
fn checksum() -> u32 {
    let mut hash = Fnv::default();
    for (rows, inner, n) in [(64, 64, 64), (33, 129, 5), (7, 300, 19)] {
        let a: Vec<f32> = (0..rows * inner).map(|i| ((i * 37 % 101) as f32 - 50.0) / 37.0).collect();
        let b: Vec<f32> = (0..inner * n).map(|i| ((i * 53 % 97) as f32 - 48.0) / 41.0).collect();
        let mut c = vec![0.0; rows * n];
        multiply(Left::new(&a, rows, inner), &b, n, Around::default(), &mut c);
        hash.write(&c);
    }
    (hash.finish() ^ (hash.finish() >> 32)) as u32
}

/// What is multiplied.
#[derive(Clone, Copy)]
struct Product<'a> {
    a: Left<'a>,
    b: &'a [f32],
    n: usize,
}

struct Multiply<'a> {
    product: Product<'a>,
    around: Around<'a>,
    c: &'a mut [f32],
}

impl WithSimd for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { product, around, c } = self;
        let inner = product.a.inner;
        let mut first = 0;
        loop {
            let last = inner.min(first + PASS);
            let pass = Pass { simd, product, around, inner: first..last };
            // As many sums as leave registers for a row of b: AVX-512 and NEON have 32 of them, AVX2 has 16.
            // One sum too many and the compiler keeps them all in memory, at half the speed.
            if S::F32_LANES == 16 || cfg!(target_arch = "aarch64") {
                pass.columns::<6, 4>(c);
            } else {
                pass.columns::<4, 3>(c);
            }
            first = last;
            if first == inner {
                return;
            }
        }
    }
}

/// One pass over a part of the inner dimension; passes before it left their sums in c.
struct Pass<'a, S> {
    simd: S,
    product: Product<'a>,
    around: Around<'a>,
    inner: Range<usize>,
}

impl<S: Simd> Pass<'_, S> {
    /// All columns, in strips of `V` vectors, then of two, then one, then what is left of one.
    #[inline(always)]
    fn columns<const R: usize, const V: usize>(&self, c: &mut [f32]) {
        let (n, lanes) = (self.product.n, S::F32_LANES);
        let mut j = 0;
        while j + V * lanes <= n {
            self.rows::<R, V, false>(j, c);
            j += V * lanes;
        }
        while j + 2 * lanes <= n {
            self.rows::<R, 2, false>(j, c);
            j += 2 * lanes;
        }
        while j + lanes <= n {
            self.rows::<8, 1, false>(j, c);
            j += lanes;
        }
        if j < n {
            self.rows::<8, 1, true>(j, c);
        }
    }

    /// All rows of a strip of columns.
    #[inline(always)]
    fn rows<const R: usize, const V: usize, const PART: bool>(&self, j: usize, c: &mut [f32]) {
        let rows = self.product.a.rows;
        let mut i = 0;
        while i + R <= rows {
            self.tile::<R, V, PART>(i, j, c);
            i += R;
        }
        while i + 2 <= rows {
            self.tile::<2, V, PART>(i, j, c);
            i += 2;
        }
        if i < rows {
            self.tile::<1, V, PART>(i, j, c);
        }
    }

    /// `R` rows and `V` vectors of c, kept in registers for the whole pass.
    #[inline(always)]
    fn tile<const R: usize, const V: usize, const PART: bool>(&self, i: usize, j: usize, c: &mut [f32]) {
        let Product { a, b, n } = self.product;
        let mut sums = [[self.simd.splat_f32s(0.0); V]; R];
        if self.inner.start > 0 {
            for (r, sums) in sums.iter_mut().enumerate() {
                *sums = self.load::<V, PART>(&c[(i + r) * n..][..n], j);
            }
        } else if let Some(bias) = self.around.bias {
            sums = [self.load::<V, PART>(bias, j); R];
        }
        let rows_of_b = b[self.inner.start * n..self.inner.end * n].chunks_exact(n);
        if a.transposed {
            let rows_of_a = a.data[self.inner.start * a.rows..].chunks_exact(a.rows);
            for (b, a) in rows_of_b.zip(rows_of_a) {
                let a = &a[i..i + R];
                self.add_products::<R, V, PART>(&mut sums, b, j, |r| a[r]);
            }
        } else {
            let rows: [&[f32]; R] =
                std::array::from_fn(|r| &a.data[(i + r) * a.inner + self.inner.start..][..self.inner.len()]);
            for (k, b) in rows_of_b.enumerate() {
                self.add_products::<R, V, PART>(&mut sums, b, j, |r| rows[r][k]);
            }
        }
        // Without a branch around the tile, which would cost it its registers. NaN comes through.
        let least = if self.around.relu && self.inner.end == a.inner { 0.0 } else { f32::NEG_INFINITY };
        let least = self.simd.splat_f32s(least);
        for (r, sums) in sums.into_iter().enumerate() {
            let sums = sums.map(|sum| self.simd.max_f32s(least, sum));
            self.store::<V, PART>(&mut c[(i + r) * n..][..n], j, sums);
        }
    }

    /// sums += a column of the tile's rows of a times a row of the tile's columns of b.
    #[inline(always)]
    fn add_products<const R: usize, const V: usize, const PART: bool>(
        &self,
        sums: &mut [[S::f32s; V]; R],
        b: &[f32],
        j: usize,
        a: impl Fn(usize) -> f32,
    ) {
        let b = self.load::<V, PART>(b, j);
        for (r, sums) in sums.iter_mut().enumerate() {
            let a = self.simd.splat_f32s(a(r));
            for (sum, &b) in sums.iter_mut().zip(&b) {
                *sum = self.simd.mul_add_e_f32s(a, b, *sum);
            }
        }
    }

    #[inline(always)]
    fn load<const V: usize, const PART: bool>(&self, row: &[f32], j: usize) -> [S::f32s; V] {
        if PART {
            return [self.simd.partial_load_f32s(&row[j..]); V];
        }
        let (vectors, _) = S::as_simd_f32s(&row[j..j + V * S::F32_LANES]);
        std::array::from_fn(|v| vectors[v])
    }

    #[inline(always)]
    fn store<const V: usize, const PART: bool>(&self, row: &mut [f32], j: usize, sums: [S::f32s; V]) {
        if PART {
            return self.simd.partial_store_f32s(&mut row[j..], sums[0]);
        }
        let (vectors, _) = S::as_mut_simd_f32s(&mut row[j..j + V * S::F32_LANES]);
        vectors.copy_from_slice(&sums);
    }
}

/// Writes the transpose of `matrix`, `rows` × `cols`, row-major.
///
/// In square blocks: a whole row would be scattered over as many cache lines as it has numbers, which at widths
/// of a power of two all fall on the same few places of the cache.
pub(crate) fn transpose(matrix: &[f32], rows: usize, cols: usize, transposed: &mut [f32]) {
    vectorised(|| {
        for top in (0..rows).step_by(BLOCK) {
            for left in (0..cols).step_by(BLOCK) {
                transpose_block(matrix, (rows, cols), (top, left), transposed);
            }
        }
    });
}

const BLOCK: usize = 8;

#[inline(always)]
fn transpose_block(
    matrix: &[f32],
    (rows, cols): (usize, usize),
    (top, left): (usize, usize),
    transposed: &mut [f32],
) {
    if top + BLOCK > rows || left + BLOCK > cols {
        for row in top..rows.min(top + BLOCK) {
            (left..cols.min(left + BLOCK))
                .for_each(|col| transposed[col * rows + row] = matrix[row * cols + col]);
        }
        return;
    }
    let mut block = [[0.0; BLOCK]; BLOCK];
    for (i, row) in block.iter_mut().enumerate() {
        row.copy_from_slice(&matrix[(top + i) * cols + left..][..BLOCK]);
    }
    for j in 0..BLOCK {
        let column = block.map(|row| row[j]);
        transposed[(left + j) * rows + top..][..BLOCK].copy_from_slice(&column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn numbers(seed: usize, n: usize) -> Vec<f32> {
        (0..n).map(|i| (((i + seed) * 7919 % 1009) as f32 - 504.0) / 311.0).collect()
    }

    /// The definition: each element one chain of fused multiply-adds, first to last.
    fn by_definition(a: impl Fn(usize, usize) -> f32, inner: usize, b: &[f32], n: usize, c: &mut [f32]) {
        for (i, row) in c.chunks_exact_mut(n).enumerate() {
            for (j, c) in row.iter_mut().enumerate() {
                *c = (0..inner).fold(*c, |sum, k| a(i, k).mul_add(b[k * n + j], sum));
            }
        }
    }

    /// A product on one instruction set.
    fn product_on(dispatch: impl FnOnce(Multiply), product: Product, around: Around) -> Vec<f32> {
        let mut c = vec![f32::NAN; product.a.rows * product.n];
        dispatch(Multiply { product, around, c: &mut c });
        c
    }

    proptest! {
        /// Every instruction set with fused multiply-add gives the bits of the definition; without it the
        /// same to rounding.
        #[test]
        fn every_instruction_set_keeps_the_order_of_summation(
            rows in 0usize..20,
            inner in 0usize..300,
            n in 1usize..70,
            transposed: bool,
            with_bias: bool,
            relu: bool,
        ) {
            let (data, b, bias) = (numbers(1, rows * inner), numbers(2, inner * n), numbers(3, n));
            let a = if transposed {
                Left::new(&data, inner, rows).transposed()
            } else {
                Left::new(&data, rows, inner)
            };
            let at = |i: usize, k: usize| if transposed { data[k * rows + i] } else { data[i * inner + k] };
            let mut expected = if with_bias { bias.repeat(rows) } else { vec![0.0; rows * n] };
            by_definition(at, inner, &b, n, &mut expected);
            if relu {
                expected.iter_mut().for_each(|x| *x = x.max(0.0));
            }
            let product = Product { a, b: &b, n };
            let around = Around { bias: with_bias.then_some(&bias), relu };

            let plain = product_on(|m| m.with_simd(pulp::Scalar::new()), product, around);
            for (p, e) in plain.iter().zip(&expected) {
                prop_assert!((p - e).abs() < 1e-3, "{} {}", p, e);
            }
            #[cfg(target_arch = "x86_64")]
            {
                if let Some(v3) = pulp::x86::V3::try_new() {
                    let found = product_on(|m| Simd::vectorize(v3, m), product, around);
                    prop_assert_eq!(&found, &expected);
                }
                if let Some(v4) = pulp::x86::V4::try_new() {
                    let found = product_on(|m| Simd::vectorize(v4, m), product, around);
                    prop_assert_eq!(&found, &expected);
                }
            }
            #[cfg(target_arch = "aarch64")]
            if let Some(neon) = pulp::aarch64::Neon::try_new() {
                let found = product_on(|m| Simd::vectorize(neon, m), product, around);
                prop_assert_eq!(&found, &expected);
            }
        }

        #[test]
        fn transposing_twice_gives_the_matrix(rows in 1usize..40, cols in 1usize..40) {
            let matrix = numbers(4, rows * cols);
            let (mut once, mut twice) = (vec![0.0; rows * cols], vec![0.0; rows * cols]);
            transpose(&matrix, rows, cols, &mut once);
            transpose(&once, cols, rows, &mut twice);
            prop_assert_eq!(once.get(1).copied(), matrix.get(if rows > 1 { cols } else { 1 }).copied());
            prop_assert_eq!(twice, matrix);
        }
    }

    /// What model cards say is what was computed: the checksum of the fused kernels is one number everywhere.
    #[test]
    fn name_of_the_kernel() {
        assert!(
            ["fused 4a53be04", "unfused"].iter().any(|n| kernel_name().starts_with(n)),
            "{}",
            kernel_name()
        );
    }
}
