//! `cargo run --release -p cohelm-nn --example timings`: what `cohelm bench nets` measures, and the matrix
//! products of those steps beside crate `matrixmultiply`.
#![allow(unsafe_code, reason = "matrixmultiply takes pointers")]

use std::hint::black_box;
use std::time::Instant;

use cohelm_nn::bench;

fn main() {
    let timings = bench::measure(300);
    println!("kernel {}, {:.0} GFLOP/s", timings.kernel, timings.gflops);
    for t in timings.timings {
        let ratio =
            t.floor_us.map_or(String::new(), |f| format!("  floor {f:7.1}  ratio {:.2}", t.median_us / f));
        println!("{:58} median {:8.2}  best {:8.2} us{ratio}", t.name, t.median_us, t.best_us);
    }
    println!("product               ours  matrixmultiply (us, best)");
    let shapes = [
        [128, 13, 64],
        [128, 64, 64],
        [128, 64, 5],
        [64, 128, 128],
        [64, 90, 256],
        [64, 256, 64],
        [512, 512, 512],
    ];
    for shape in shapes {
        let [rows, inner, n] = shape;
        let name = format!("{rows}x{inner}x{n}");
        println!("{name:15} {:10.2}  {:10.2}", bench::product(shape, 300).best_us, library(shape, 300));
    }
}

/// Best of `runs` batches of products by `matrixmultiply`, in microseconds each.
fn library([rows, inner, n]: [usize; 3], runs: usize) -> f64 {
    let (a, b) = (vec![0.5f32; rows * inner], vec![0.25f32; inner * n]);
    let mut c = vec![0.0f32; rows * n];
    let repetitions = (2e7 / (rows * inner * n) as f64).ceil() as usize;
    let mut batch = || {
        let start = Instant::now();
        for _ in 0..repetitions {
            let (a, b, c) = (black_box(&a).as_ptr(), black_box(&b).as_ptr(), c.as_mut_ptr());
            let (inner_step, n_step) = (inner as isize, n as isize);
            // SAFETY: the slices have rows x inner, inner x n and rows x n elements, row-major without gaps.
            unsafe {
                matrixmultiply::sgemm(rows, inner, n, 1.0, a, inner_step, 1, b, n_step, 1, 0.0, c, n_step, 1);
            }
        }
        start.elapsed().as_secs_f64() * 1e6 / repetitions as f64
    };
    (0..runs).map(|_| batch()).fold(f64::MAX, f64::min)
}
