//! Exported source, compiled and run, against the model itself.

use std::path::Path;
use std::process::Command;

use faer::Mat;
use phalanx_rvm::{Error, Kernel, Model, MultiOutputRvm, Regressor, RelevanceVectorMachine, Ridge};

use crate::problems::{close, smooth};

/// A linear model, Gaussians shared and by target, and one with every column pruned.
fn models() -> (Mat<f64>, Vec<Model>) {
    let (x, y) = smooth(11, 5, 2, 40);
    let (x, y) = (x.as_ref(), y.as_ref());
    let pruned =
        RelevanceVectorMachine { min_evidence_gain: 1e9, ..RelevanceVectorMachine::default() };
    let fits = [
        Ridge { kernel: Kernel::Linear, ..Ridge::default() }.fit(x, y),
        MultiOutputRvm::default().fit(x, y),
        RelevanceVectorMachine::default().fit(x, y),
        pruned.fit(x, y),
    ];
    (x.to_owned(), fits.into_iter().map(|fit| fit.unwrap().model).collect())
}

/// Runs a program that prints its predictions, one number a line, sample by sample.
fn predictions(program: &Path, model: &Model, samples: usize) -> Mat<f64> {
    let output = Command::new(program).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let values: Vec<f64> = text.lines().map(|line| line.parse().unwrap()).collect();
    Mat::from_fn(model.outputs(), samples, |j, t| values[t * model.outputs() + j])
}

/// The samples as rows of a list with these brackets.
fn listed(x: &Mat<f64>, open: char, close: char) -> String {
    let rows = x.col_iter().map(|sample| {
        let numbers: Vec<String> = sample.iter().map(|v| format!("{v:e}")).collect();
        format!("{open}{}{close}", numbers.join(", "))
    });
    rows.collect::<Vec<_>>().join(",\n")
}

/// Compiles and runs what `write` makes of each model.
fn compile_and_compare(
    extension: &str,
    compiler: impl Fn(&Path, &Path) -> Command,
    write: impl Fn(&Model, &Mat<f64>) -> String,
) {
    let folder =
        std::env::temp_dir().join(format!("phalanx-rvm-export-{}-{extension}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (x, models) = models();
    for (number, model) in models.iter().enumerate() {
        let (source, program) =
            (folder.join(format!("{number}.{extension}")), folder.join(number.to_string()));
        std::fs::write(&source, write(model, &x)).unwrap();
        let output = compiler(&source, &program).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let found = predictions(&program, model, x.ncols());
        let expected = model.predict(x.as_ref()).unwrap();
        assert!(close(found.as_ref(), expected.as_ref(), 1e-12));
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn rust_source_predicts_as_the_model_does() {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let compiler = |source: &Path, program: &Path| {
        let mut command = Command::new(&rustc);
        command.args(["--edition", "2021", "-D", "warnings", "-o"]).arg(program).arg(source);
        command
    };
    compile_and_compare("rs", compiler, |model, x| {
        format!(
            "mod model {{ #![allow(dead_code)]\n{}}}\nfn main() {{ for x in [{}] {{ \
             for y in model::predict(&x) {{ println!(\"{{y:e}}\"); }} }} }}",
            model.to_rust(),
            listed(x, '[', ']')
        )
    });
}

#[test]
fn a_c_header_predicts_as_the_model_does() {
    if Command::new("cc").arg("--version").output().is_err() {
        eprintln!("skipped: no C compiler");
        return;
    }
    let compiler = |source: &Path, program: &Path| {
        let mut command = Command::new("cc");
        command.args(["-std=c99", "-Wall", "-Werror", "-o"]).arg(program).arg(source).arg("-lm");
        command
    };
    compile_and_compare("c", compiler, |model, x| {
        format!(
            "{}\n#include <stdio.h>\nstatic const double X[][{}] = {{{}}};\nint main(void) {{ \
             for (int t = 0; t < {}; ++t) {{ double y[HAND_OUTPUTS]; hand_predict(X[t], y); \
             for (int j = 0; j < HAND_OUTPUTS; ++j) printf(\"%.17g\\n\", y[j]); }} return 0; }}",
            model.to_c("hand").unwrap(),
            model.inputs(),
            listed(x, '{', '}'),
            x.ncols()
        )
    });
}

#[test]
fn names_that_c_does_not_take_are_refused() {
    let (_, models) = models();
    for name in ["", "2d", "a-b", "x y", "ü"] {
        assert_eq!(models[0].to_c(name), Err(Error::Identifier { name: name.to_owned() }));
    }
}
