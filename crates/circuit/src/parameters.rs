//! What a compiled model offers: parameters with values and limits, inputs, variables.

use super::Simulation;
use bramah_expr::VarId;
use bramah_model::flat::Variability;
use bramah_results::Signal;
use bramah_solve as solve;
use bramah_syntax::diag::Error;

/// A parameter that may be given from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name, units, description and type.
    pub signal: Signal,
    /// The value in the next run, in the parameter's unit. Booleans are 0 or 1, enumerations the number of their
    /// literal.
    /// A parameter that is computed at the start has its guess here.
    pub value: f64,
    /// The smallest value allowed, in its unit.
    pub min: Option<f64>,
    /// The largest value allowed, in its unit.
    pub max: Option<f64>,
    /// No other parameter decides its value.
    pub root: bool,
    /// The structure of the model depends on it: a new value needs a new compilation.
    pub structural: bool,
}

impl Simulation {
    /// The parameters that may be given from outside, in the order of their declaration: neither `final` nor protected.
    /// Texts are not among them.
    pub fn parameters(&self) -> Vec<Parameter> {
        let (system, values) = (&self.model().system, self.parameter_values());
        let settable: Vec<VarId> = self.all().filter(|v| self.model().dae.variables[v.index()].settable).collect();
        let signals = solve::signals(&self.model().dae, &settable);
        let parameter = |(v, signal): (VarId, Signal)| Parameter {
            signal,
            value: values[system.layout.var(v)],
            min: system.min(v, &values),
            max: system.max(v, &values),
            root: self.model().flat.is_root(v),
            structural: self.model().dae.variables[v.index()].variability == Variability::Constant,
        };
        settable.into_iter().zip(signals).map(parameter).collect()
    }

    /// The inputs of the model: values come from outside during a run.
    pub fn inputs(&self) -> Vec<Signal> {
        solve::signals(&self.model().dae, &self.model().dae.inputs)
    }

    /// Names of the model's own outputs.
    pub fn outputs(&self) -> Vec<String> {
        self.model().flat.variables.iter().filter(|v| v.output).map(|v| v.name.clone()).collect()
    }

    /// The value of an input before it is set: its default, or its start value.
    ///
    /// # Errors
    /// `E023` when the model has no such variable.
    pub fn start_of(&self, name: &str) -> Result<f64, Error> {
        let v = self.variable(name)?;
        let model = self.model();
        // A constant start value in the text counts; else the guess from which initialization begins.
        let own = model.flat.variables[v.index()].binding.and_then(|b| model.flat.exprs.as_num(b));
        Ok(own.unwrap_or_else(|| solve::guesses(&model.system, self.run_settings())[model.system.layout.var(v)]))
    }

    /// Variables that change during a run, without protected ones.
    pub fn variables(&self) -> Vec<Signal> {
        solve::signals(&self.model().dae, &self.changing())
    }

    /// Chooses to record the variables that change during a run, without parameters and protected ones.
    pub fn record_variables(&mut self) -> &mut Self {
        let changing = self.changing();
        self.settings().wanted = changing;
        self
    }

    fn changing(&self) -> Vec<VarId> {
        let dae = &self.model().dae;
        let changes = |v: &VarId| dae.variables[v.index()].variability > Variability::Parameter && dae.is_shown(*v);
        self.all().filter(changes).collect()
    }

    fn all(&self) -> impl Iterator<Item = VarId> {
        (0u32..).zip(&self.model().dae.variables).map(|(i, _)| VarId(i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_model_offers() {
        let simulation = Simulation::from_text(
            "model M
               parameter Real k(min = 0, max = 2*c, unit = \"m\", displayUnit = \"mm\") = 0.5*c \"gain\";
               constant Real c = 3;
               final parameter Real f = 2*k;
               parameter Integer n = 2;
               input Real u(unit = \"m\");
               Real x[n](each start = 0, each fixed = true);
             protected
               parameter Real p = 1;
             equation
               der(x) = fill(k*u*f*p, n);
             end M;",
        )
        .unwrap();
        let parameters = simulation.parameters();
        let seen: Vec<(&str, f64, Option<f64>, bool)> =
            parameters.iter().map(|p| (p.signal.name.as_str(), p.value, p.max, p.structural)).collect();
        assert_eq!(seen, [("k", 1.5, Some(6.0), false), ("n", 2.0, None, true)]);
        assert_eq!(parameters[0].signal.display_unit, "mm");
        assert_eq!(parameters[0].signal.description, "gain");
        assert_eq!(simulation.inputs()[0].unit, "m");
        let names: Vec<String> = simulation.variables().into_iter().map(|s| s.name).collect();
        assert_eq!(names, ["u", "x[1]", "x[2]"]);
        let refused = simulation.clone().set("f", 1.0).unwrap_err().to_string();
        assert!(refused.contains("E023") && refused.contains("`f` is final"), "{refused}");
    }
}
