//! Source code for fitted models.

use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::parts::Basis;
use crate::model::regressor::Regressor;

impl Model {
    /// The model's mean prediction as Rust source: a module with `INPUTS`, `OUTPUTS`, the `NOISE`
    /// deviation of each target and `predict`, which needs `std` (for the exponential) but no crate
    /// and no allocation. Results equal those of [`predict_mean_into`](Self::predict_mean_into) to
    /// rounding. No phalanx pipeline uses it; it is for those who use this crate alone.
    ///
    /// ```
    /// use phalanx_rvm::{Ridge, faer::Mat};
    ///
    /// # fn main() -> phalanx_rvm::Result<()> {
    /// let x = Mat::from_fn(2, 9, |i, t| (t * (i + 1) % 5) as f64);
    /// let y = Mat::from_fn(1, 9, |_, t| x[(0, t)] - x[(1, t)]);
    /// let source = Ridge::default().fit(x.as_ref(), y.as_ref())?.model.to_rust();
    /// assert!(source.contains("pub fn predict(x: &[f64; INPUTS]) -> [f64; OUTPUTS]"));
    /// # Ok(())
    /// # }
    /// ```
    pub fn to_rust(&self) -> String {
        let tables = self.tables();
        let constants = tables.iter().map(|Table { name, whole, values }| {
            let kind = if *whole { "usize" } else { "f64" };
            format!("const {name}: [{kind}; {}] = [{}];\n", values.len(), values.join(", "))
        });
        let constants = constants.collect::<Vec<_>>().concat();
        let noise = numbers(&self.noise()).join(", ");
        let (inputs, outputs) = (self.inputs(), self.outputs());
        let body = if self.parts().column_means.is_empty() {
            "    let _ = x;\n    BIAS\n".to_owned()
        } else {
            RUST_BODY.replace(
                "VALUE",
                match &self.parts().basis {
                    Basis::Linear => "(x[FEATURES[k]] - FEATURE_MEANS[k]) / FEATURE_SCALES[k]",
                    Basis::Gaussian { .. } => "gaussian(x, k)",
                },
            )
        };
        let gaussian = match &self.parts().basis {
            Basis::Gaussian { beta, .. } => RUST_GAUSSIAN.replace("BETA", &format!("{beta:e}")),
            Basis::Linear => String::new(),
        };
        format!(
            "// A regressor exported by phalanx-rvm.\n\n\
             /// Length of an input.\npub const INPUTS: usize = {inputs};\n\
             /// Length of a prediction.\npub const OUTPUTS: usize = {outputs};\n\
             /// Standard deviation of each target's noise; infinite where it is not known.\n\
             pub const NOISE: [f64; OUTPUTS] = [{noise}];\n\n{constants}{gaussian}\n\
             /// Mean of the targets at one input.\n\
             pub fn predict(x: &[f64; INPUTS]) -> [f64; OUTPUTS] {{\n{body}}}\n"
        )
    }

    /// The model's mean prediction as a C99 header: `<name>_predict(x, y)` and the sizes
    /// `<NAME>_INPUTS` and `<NAME>_OUTPUTS`. It needs only `math.h`. `name` must be a C identifier.
    ///
    /// ```
    /// use phalanx_rvm::{Ridge, faer::Mat};
    ///
    /// # fn main() -> phalanx_rvm::Result<()> {
    /// let x = Mat::from_fn(2, 9, |i, t| (t * (i + 1) % 5) as f64);
    /// let y = Mat::from_fn(1, 9, |_, t| x[(0, t)] - x[(1, t)]);
    /// let header = Ridge::default().fit(x.as_ref(), y.as_ref())?.model.to_c("tilt")?;
    /// assert!(header.contains("static void tilt_predict(const double *x, double *y)"));
    /// # Ok(())
    /// # }
    /// ```
    pub fn to_c(&self, name: &str) -> Result<String> {
        let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        if !starts || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            return Err(Error::Identifier { name: name.to_owned() });
        }
        let upper = name.to_ascii_uppercase();
        let tables = self.tables();
        let filled = tables.iter().filter(|table| !table.values.is_empty());
        let constants = filled.map(|Table { name: table, whole, values }| {
            let kind = if *whole { "int" } else { "double" };
            format!("static const {kind} {upper}_{table}[] = {{{}}};\n", values.join(", "))
        });
        let constants = constants.collect::<Vec<_>>().concat();
        let columns = self.parts().column_means.len();
        let features = self.parts().features.len();
        let value = match &self.parts().basis {
            _ if columns == 0 => "",
            Basis::Linear => C_LINEAR,
            Basis::Gaussian { .. } => C_GAUSSIAN,
        };
        let beta = match &self.parts().basis {
            Basis::Gaussian { beta, .. } => format!("{beta:e}"),
            Basis::Linear => String::new(),
        };
        let value = value
            .replace("BETA", &beta)
            .replace("COUNT", &columns.to_string())
            .replace("READ", &features.to_string());
        let body = C_BODY.replace("/*columns*/", &value).replace("UPPER", &upper);
        let (inputs, outputs) = (self.inputs(), self.outputs());
        Ok(format!(
            "/* A regressor exported by phalanx-rvm. */\n\
             #ifndef {upper}_INPUTS\n#define {upper}_INPUTS {inputs}\n\
             #define {upper}_OUTPUTS {outputs}\n#include <math.h>\n\n{constants}\n\
             /* Mean of the targets y at the input x. */\n\
             static void {name}_predict(const double *x, double *y) {{\n{body}}}\n#endif\n"
        ))
    }

    /// The model's numbers, by name.
    fn tables(&self) -> Vec<Table> {
        let parts = self.parts();
        let real = |name, values: &[f64]| Table { name, whole: false, values: numbers(values) };
        let features = parts.features.iter().map(usize::to_string).collect();
        let mut tables = vec![real("BIAS", &parts.bias)];
        if !parts.column_means.is_empty() {
            tables.push(Table { name: "FEATURES", whole: true, values: features });
            tables.push(real("FEATURE_MEANS", &parts.feature_means));
            tables.push(real("FEATURE_SCALES", &parts.feature_scales));
            tables.push(real("COLUMN_MEANS", &parts.column_means));
            tables.push(real("WEIGHTS", &parts.weights));
            if let Basis::Gaussian { centres, .. } = &parts.basis {
                tables.push(real("CENTRES", centres));
            }
        }
        tables
    }
}

/// Constants of the generated source.
struct Table {
    name: &'static str,
    /// Indices rather than reals.
    whole: bool,
    values: Vec<String>,
}

/// The shortest decimals that are read back as these numbers.
fn numbers(values: &[f64]) -> Vec<String> {
    // Only the noise can be infinite, of which C has no table.
    let literal = |value: &f64| {
        if value.is_finite() { format!("{value:e}") } else { "f64::INFINITY".to_owned() }
    };
    values.iter().map(literal).collect()
}

const RUST_BODY: &str = "    let mut y = BIAS;
    for (k, mean) in COLUMN_MEANS.iter().enumerate() {
        let value = VALUE - mean;
        for (j, y) in y.iter_mut().enumerate() {
            *y += value * WEIGHTS[k * OUTPUTS + j];
        }
    }
    y
";

const RUST_GAUSSIAN: &str = "
fn gaussian(x: &[f64; INPUTS], k: usize) -> f64 {
    let mut squared = 0.0;
    for (i, &feature) in FEATURES.iter().enumerate() {
        let z = (x[feature] - FEATURE_MEANS[i]) / FEATURE_SCALES[i];
        let difference = z - CENTRES[i * COLUMN_MEANS.len() + k];
        squared += difference * difference;
    }
    (-BETA * squared).exp()
}
";

const C_BODY: &str = "    for (int j = 0; j < UPPER_OUTPUTS; ++j) y[j] = UPPER_BIAS[j];
/*columns*/";

const C_LINEAR: &str = "    for (int k = 0; k < COUNT; ++k) {
        double value = (x[UPPER_FEATURES[k]] - UPPER_FEATURE_MEANS[k]) / UPPER_FEATURE_SCALES[k];
        value -= UPPER_COLUMN_MEANS[k];
        for (int j = 0; j < UPPER_OUTPUTS; ++j) y[j] += value * UPPER_WEIGHTS[k * UPPER_OUTPUTS + j];
    }
";

const C_GAUSSIAN: &str = "    for (int k = 0; k < COUNT; ++k) {
        double squared = 0.0;
        for (int i = 0; i < READ; ++i) {
            double z = (x[UPPER_FEATURES[i]] - UPPER_FEATURE_MEANS[i]) / UPPER_FEATURE_SCALES[i];
            z -= UPPER_CENTRES[i * COUNT + k];
            squared += z * z;
        }
        double value = exp(-BETA * squared) - UPPER_COLUMN_MEANS[k];
        for (int j = 0; j < UPPER_OUTPUTS; ++j) y[j] += value * UPPER_WEIGHTS[k * UPPER_OUTPUTS + j];
    }
";
