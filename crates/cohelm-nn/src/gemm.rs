//! The one place that calls the GEMM library, and the only unsafe code of the crate.
//!
//! `matrixmultiply` chooses its kernel at run time (AVX-512, AVX2 with FMA, NEON, plain), so sums differ in
//! their last bits between kinds of CPU: training is repeatable on one kind only, and [`kernel_name`] says
//! which kind it was.
#![allow(unsafe_code)]

use crate::fingerprint::Fnv;

/// A matrix to read: `rows` × `cols`, element (i, j) at `data[i * row_stride + j * col_stride]`.
#[derive(Clone, Copy)]
pub(crate) struct Matrix<'a> {
    data: &'a [f32],
    rows: usize,
    cols: usize,
    row_stride: usize,
    col_stride: usize,
}

impl<'a> Matrix<'a> {
    /// Row after row without gaps.
    pub fn new(data: &'a [f32], rows: usize, cols: usize) -> Self {
        assert!(rows * cols <= data.len(), "{rows} x {cols} numbers needed, {} given", data.len());
        Self { data, rows, cols, row_stride: cols, col_stride: 1 }
    }

    /// `count` neighbouring columns from `first` on.
    pub fn columns(self, first: usize, count: usize) -> Self {
        assert!(first + count <= self.cols, "columns {first}..{} of {}", first + count, self.cols);
        let offset = (first * self.col_stride).min(self.data.len());
        Self { data: &self.data[offset..], cols: count, ..self }
    }

    /// The same numbers with rows and columns exchanged.
    pub fn transposed(self) -> Self {
        Self {
            data: self.data,
            rows: self.cols,
            cols: self.rows,
            row_stride: self.col_stride,
            col_stride: self.row_stride,
        }
    }
}

/// Which kind of GEMM kernel this CPU gets, and a checksum of what it computes.
///
/// Two machines with the same name train the same weights from the same seed; the checksum is over the bits of
/// a few fixed products, so that a compiler that builds other kernels into the library shows as well.
#[must_use]
pub fn kernel_name() -> String {
    format!("matrixmultiply {} {:08x}", instruction_set(), checksum())
}

/// The widest instruction set that the library looks for and this CPU has.
fn instruction_set() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if std::is_x86_feature_detected!("avx512f") {
            return "avx512";
        }
        if std::is_x86_feature_detected!("fma") && std::is_x86_feature_detected!("avx2") {
            return "avx2+fma";
        }
        if std::is_x86_feature_detected!("avx") {
            return "avx";
        }
    }
    #[cfg(target_arch = "aarch64")]
    if std::arch::is_aarch64_feature_detected!("neon") {
        return "neon";
    }
    "plain"
}

/// FNV-1a over the products of a few fixed matrices, among them shapes with remainders for every kernel.
fn checksum() -> u32 {
    let mut hash = Fnv::default();
    for (m, k, n) in [(128, 64, 64), (33, 129, 5), (7, 300, 19)] {
        let a: Vec<f32> = (0..m * k).map(|i| ((i * 37 % 101) as f32 - 50.0) / 37.0).collect();
        let b: Vec<f32> = (0..k * n).map(|i| ((i * 53 % 97) as f32 - 48.0) / 41.0).collect();
        let mut c = vec![0.0; m * n];
        multiply(Matrix::new(&a, m, k), Matrix::new(&b, k, n), false, &mut c);
        hash.write(&c);
    }
    (hash.finish() ^ (hash.finish() >> 32)) as u32
}

/// c = a·b, or c += a·b if `add`; `c` is row-major without gaps.
pub(crate) fn multiply(a: Matrix, b: Matrix, add: bool, c: &mut [f32]) {
    assert_eq!(a.cols, b.rows, "inner sizes differ");
    let (m, k, n) = (a.rows, a.cols, b.cols);
    assert!(m * n <= c.len(), "{m} x {n} numbers to write, room for {}", c.len());
    let beta = if add { 1.0 } else { 0.0 };
    // SAFETY: `Matrix::new` saw that all rows × cols elements of `a` and `b` lie inside their slices, and
    // transposing only exchanges the strides; the assertion above does the same for `c`, which is borrowed
    // mutably and so overlaps neither.
    unsafe {
        matrixmultiply::sgemm(
            m,
            k,
            n,
            1.0,
            a.data.as_ptr(),
            a.row_stride as isize,
            a.col_stride as isize,
            b.data.as_ptr(),
            b.row_stride as isize,
            b.col_stride as isize,
            beta,
            c.as_mut_ptr(),
            n as isize,
            1,
        );
    }
}
