//! Parameter sweeps: many runs of one model with different parameters, and the scalar results of each.
//!
//! A compiled model and the section `[sweep]` of an experiment file enter; a [`SweepPlan`] leaves, whose runs the
//! command `bramah sweep` makes in parallel. Their results go into a [`SweepTable`], from which Sobol' indices
//! ([`indices`]) and pictures are made.

mod picture;
mod result;
mod sampling;
mod sobol;
mod table;

pub use picture::{matrix, scatter};
pub use result::ResultExpression;
pub use sampling::{SweepParameter, XorshiftGenerator, quantile, samples};
pub use sobol::{SobolIndex, indices};
pub use table::{SweepTable, fingerprint};

use super::linear::outputs;
use crate::experiment::ParameterSweep;
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_model::flat::{ScalarType, Variability};
use bramah_model::structure::StateChoice;
use bramah_results::Trajectory;
use bramah_solve::{Control, Settings, signals, simulate};
use bramah_syntax::diag::{Code, Diagnostic, nearest};
use std::sync::atomic::AtomicBool;

/// A sweep whose names are resolved in a model.
#[derive(Clone, Debug)]
pub struct SweepPlan {
    /// The parameters that vary.
    pub varied: Vec<SweepParameter>,
    /// The variables of these parameters.
    variables: Vec<VarId>,
    /// Parameter values of all runs: one row for each run, one column for each parameter.
    pub samples: Vec<Vec<f64>>,
    /// Names and expressions of the results.
    pub results: Vec<(String, ResultExpression)>,
    /// The variables that the results read; runs record these.
    pub wanted: Vec<VarId>,
}

impl SweepPlan {
    /// Resolves a sweep in a model and draws its samples. All mistakes are collected.
    ///
    /// # Errors
    /// [`Code::BadExperiment`]: names that the model does not have, parameters on which its structure depends, values
    /// that do not fit, expressions that cannot be read.
    pub fn new(model: &CompiledModel, sweep: &ParameterSweep) -> Result<SweepPlan, Vec<Diagnostic>> {
        let mut found = Vec::new();
        let mut varied = Vec::new();
        let mut variables = Vec::new();
        for (name, spread) in &sweep.parameters {
            match parameter(model, name) {
                Ok((v, unit, value)) => {
                    variables.push(v);
                    varied.push(SweepParameter { name: name.clone(), unit, value, spread: spread.clone() });
                }
                Err(d) => found.push(d),
            }
        }
        let bad = |text: String| Diagnostic::new(Code::BadExperiment, text);
        let mut results = Vec::new();
        for (name, text) in &sweep.results {
            match ResultExpression::parse(text) {
                Ok(e) => results.push((name.clone(), e)),
                Err(why) => found.push(bad(format!("the result `{name}`: {why}"))),
            }
        }
        let mut names: Vec<String> = results.iter().flat_map(|(_, e)| e.variables()).collect();
        names.sort();
        names.dedup();
        let wanted = outputs(&model.flat, &names).unwrap_or_else(|d| {
            found.push(d);
            Vec::new()
        });
        let samples = if found.is_empty() {
            samples(sweep, &varied).unwrap_or_else(|why| {
                found.push(bad(why));
                Vec::new()
            })
        } else {
            Vec::new()
        };
        if found.is_empty() { Ok(SweepPlan { varied, variables, samples, results, wanted }) } else { Err(found) }
    }

    /// Makes the run of one row of samples. Returns its results and its rows.
    ///
    /// # Errors
    /// The message of the run.
    pub fn run(
        &self,
        model: &CompiledModel,
        settings: &Settings,
        index: usize,
        interrupt: &AtomicBool,
    ) -> Result<(Vec<f64>, Trajectory), String> {
        let mut settings = settings.clone();
        settings.parameters.extend(self.variables.iter().copied().zip(self.samples[index].iter().copied()));
        let mut rows = Trajectory::new(signals(&model.dae, &settings.wanted));
        let mut reselect = |choice: &StateChoice| model.with_states(choice);
        let mut control = Control { interrupt: Some(interrupt), reselect: Some(&mut reselect), ..Control::default() };
        let run = simulate(&model.system, &settings, &[], None, &mut rows, &mut control);
        if !run.end.is_success() {
            let said = run.diagnostics.iter().find(|d| d.is_error()).map(|d| d.message.clone());
            return Err(said.unwrap_or_else(|| run.end.word().to_owned()));
        }
        Ok((self.results.iter().map(|(_, e)| e.evaluate(&rows)).collect(), rows))
    }
}

/// The variable, unit and value of a parameter that can vary.
fn parameter(model: &CompiledModel, name: &str) -> Result<(VarId, String, f64), Diagnostic> {
    let variables = &model.flat.variables;
    let bad = |text: String| Diagnostic::new(Code::BadExperiment, text);
    let Some(i) = variables.iter().position(|v| v.name == name) else {
        let known = variables.iter().filter(|v| v.variability == Variability::Parameter).map(|v| v.name.as_str());
        let d = bad(format!("the model has no parameter `{name}`"));
        return Err(match nearest(name, known) {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d,
        });
    };
    let v = &variables[i];
    match v.variability {
        Variability::Parameter if v.ty == ScalarType::Real || v.ty == ScalarType::Integer => {}
        Variability::Constant => {
            return Err(bad(format!("the structure of the model depends on `{name}`, so it cannot vary in a sweep")));
        }
        _ => return Err(bad(format!("`{name}` is not a parameter with numbers"))),
    }
    let system = &model.system;
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    let id = VarId(u32::try_from(i).expect("fewer than 2^32 variables"));
    Ok((id, v.unit.as_deref().unwrap_or("").to_owned(), values[system.layout.var(id)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{ParameterVariation, SamplingMethod};
    use bramah_solve::Settings;
    use bramah_syntax::world::MemoryWorld;

    fn model(text: &str) -> CompiledModel {
        let world = MemoryWorld::single("m.mo", text);
        let request =
            bramah_model::compile::Request { source: "m.mo".into(), ..bramah_model::compile::Request::default() };
        bramah_circuit::compiled::compile(&world, &request, &bramah_solve::lower::LoweringOptions::INTERPRETED)
            .value
            .expect("sound")
    }

    const DECAY: &str = "model M parameter Real k(unit = \"1/s\") = 1; parameter Integer n = 2; Real a[n];
        Real x(start = 1, fixed = true); equation a = fill(x, n); der(x) = -k*x;
        assert(k < 5, \"too fast\"); end M;";

    fn sweep(name: &str, values: &str, result: &str) -> ParameterSweep {
        ParameterSweep {
            method: SamplingMethod::Grid,
            parameters: vec![(name.into(), ParameterVariation::Values(values.into()))],
            results: vec![("end".into(), result.into())],
            ..ParameterSweep::default()
        }
    }

    #[test]
    fn each_run_has_its_results_or_its_reason() {
        let model = model(DECAY);
        let plan = SweepPlan::new(&model, &sweep("k", "1,2,9", "final(x)")).expect("fits");
        let settings = Settings { wanted: plan.wanted.clone(), ..Settings::default() };
        let never = AtomicBool::new(false);
        let run = |i| plan.run(&model, &settings, i, &never).map(|r| r.0[0]);
        assert!((run(0).unwrap() - (-1.0f64).exp()).abs() < 1e-5);
        assert!((run(1).unwrap() - (-2.0f64).exp()).abs() < 1e-5);
        assert!(run(2).unwrap_err().contains("too fast"));
    }

    #[test]
    fn questions_without_sense() {
        let model = model(DECAY);
        let said = |s: &ParameterSweep| SweepPlan::new(&model, s).expect_err("does not fit")[0].message.clone();
        assert_eq!(said(&sweep("kk", "1", "final(x)")), "the model has no parameter `kk`");
        assert!(said(&sweep("n", "1", "final(x)")).contains("structure"));
        assert!(said(&sweep("k", "1 m", "final(x)")).contains("cannot be converted"));
        assert!(said(&sweep("k", "1", "final(y)")).contains("`y`"));
        assert!(said(&sweep("k", "1", "biggest(x)")).contains("not known"));
    }
}
