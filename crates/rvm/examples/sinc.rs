//! Fits sin(x)/x from noisy samples, each regressor by its own, and says how far off it is and
//! how often the truth lies within two standard deviations.
//!
//!     cargo run --release -p phalanx-rvm --example sinc

use phalanx_rvm::faer::Mat;
use phalanx_rvm::{
    AgarwalTriggs, Bandwidth, Fit, Kernel, KernelRidge, OrthogonalLeastSquares, Regressor,
    RelevanceVectorMachine, Result,
};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

const NOISE: f64 = 0.1;

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

fn main() -> Result<()> {
    let mut random = Pcg64Mcg::new(1);
    let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
    let x = Mat::from_fn(1, 200, |_, _| 20.0 * uniform());
    // Twelve uniform numbers sum to unit variance.
    let y = Mat::from_fn(1, 200, |_, t| {
        sinc(x[(0, t)]) + NOISE * (0..12).map(|_| uniform()).sum::<f64>()
    });
    let (x, y) = (x.as_ref(), y.as_ref());

    let width = Bandwidth::Relative(7.0);
    let kernel = Kernel::Gaussian(width);
    show(
        "RVM",
        &RelevanceVectorMachine { kernel, ..RelevanceVectorMachine::default() }.fit(x, y)?,
    )?;
    // One target alone wants a gentler prior than many that agree.
    show(
        "Agarwal-Triggs",
        &AgarwalTriggs { kernel, nu: 0.03, ..AgarwalTriggs::default() }.fit(x, y)?,
    )?;
    show(
        "OLS",
        &OrthogonalLeastSquares { kernel, count: 6, ..OrthogonalLeastSquares::default() }
            .fit(x, y)?,
    )?;
    show("kernel ridge", &KernelRidge { bandwidth: width, ..KernelRidge::default() }.fit(x, y)?)
}

fn show(name: &str, fit: &Fit) -> Result<()> {
    let n = 1000;
    let x = Mat::from_fn(1, n, |_, t| 20.0 * (t as f64 / (n - 1) as f64 - 0.5));
    let (mean, std) = fit.model.predict_with_std(x.as_ref())?;
    let mut squares = 0.0;
    let mut within = 0;
    for t in 0..n {
        let error = (mean[(0, t)] - sinc(x[(0, t)])).abs();
        squares += error * error;
        // The truth has no noise: only the function's own deviation counts.
        let function = (std[(0, t)].powi(2) - fit.model.noise()[0].powi(2)).max(0.0).sqrt();
        within += usize::from(error < 2.0 * function);
    }
    println!(
        "{name:12} {:4} centres  RMSE {:.4}  noise {:.3} (true {NOISE})  truth within 2σ: {:.0} %",
        fit.model.kept_samples().len(),
        (squares / n as f64).sqrt(),
        fit.model.noise()[0],
        100.0 * within as f64 / n as f64,
    );
    Ok(())
}
