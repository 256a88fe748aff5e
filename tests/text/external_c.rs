//! C functions of a user: called as their declarations say, only where they are allowed, with what goes wrong in words.
#![allow(clippy::disallowed_methods, reason = "writes C sources")]

use bramah::world::DiskWorld;
use bramah::{Request, Simulation};
use std::path::PathBuf;

const MODEL: &str = r#"model M
  function volumeFlow
    input Real dp; input Integer turns; input Real curve[:]; input String words; output Real q; output Real Re[2];
  external "C" q = valve_flow(dp, turns, curve, size(curve, 1), words, Re);
  end volumeFlow;
  Real p(start = 4, fixed = true), q, Re[2];
equation
  (q, Re) = volumeFlow(p, 3, {0.25, 0.75}, "a \"b\"");
  der(p) = -q;
end M;
"#;

const SOURCE: &str = r#"#include "ModelicaUtilities.h"
#include <string.h>
double valve_flow(double dp, int turns, const double *curve, size_t n, const char *words, double *Re) {
  double sum = 0;
  if (dp < 0.5) ModelicaFormatError("too little: %g", dp);
  for (size_t i = 0; i < n; i++) sum += curve[i];
  Re[0] = turns;
  Re[1] = (double) strlen(words);
  return sum * dp;
}
"#;

/// The end of a run with these sources, or the message.
fn end(stop: f64, externals: &[&str]) -> Result<Vec<f64>, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("writable");
        folder.path().join(name)
    };
    let source = file("M.mo", MODEL);
    file("valve.c", SOURCE);
    file("wrong.c", "double valve_flow(");
    let externals: Vec<PathBuf> = externals.iter().map(|name| folder.path().join(name)).collect();
    let request = Request { source, externals, ..Request::default() };
    let mut simulation = Simulation::compile(&DiskWorld, &request).map_err(|e| e.to_string())?;
    let t = simulation.stop_time(stop).run().map_err(|e| e.to_string())?.trajectory;
    Ok(["p", "q", "Re[1]", "Re[2]"].map(|name| *t.column(name).expect("a column").last().expect("a row")).to_vec())
}

#[test]
fn arguments_and_results_are_passed_as_declared() {
    let found = end(1.0, &["valve.c"]).expect("it runs");
    let wanted = 4.0 * (-1f64).exp();
    for (a, b) in found.iter().zip([wanted, wanted, 3.0, 5.0]) {
        assert!((a - b).abs() < 1e-5, "{found:?}");
    }
}

#[test]
fn what_goes_wrong_is_said() {
    let message = |stop, externals: &[&str]| end(stop, externals).expect_err("it must not run");
    assert!(message(1.0, &[]).contains("is not supported"), "{}", message(1.0, &[]));
    assert!(message(1.0, &["wrong.c"]).contains("the C compiler says"));
    assert!(message(1.0, &["missing.c"]).contains("missing.c"));
    assert!(message(4.0, &["valve.c"]).contains("too little: "), "{}", message(4.0, &["valve.c"]));
}
