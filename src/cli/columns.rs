//! Chooses the variables that a result file holds.
//!
//! The patterns of `--variables` enter; variables of the sorted model leave. Used by `simulate`, `sweep`, `sensitivity`
//! and `steady`.

use super::CommandFailure;
use super::recorder::ResultTarget;
use bramah_expr::VarId;
use bramah_model::flat::{FlatVariable, Variability};
use bramah_model::structure::Dae;
use bramah_results::GlobPatterns;
use bramah_syntax::diag::{Code, Diagnostic, nearest};

/// The variables to write, in the order of their declaration.
///
/// Without patterns these are the variables that can change and that are neither protected nor annotated `HideResult`,
/// and protected states. Formats where constants cost nothing also get the parameters. A pattern with `*` or `?`
/// chooses among these. An exact name is always written.
///
/// `Err`: a pattern matches no variable of the model.
pub(super) fn choose(dae: &Dae, patterns: &[String], target: &ResultTarget) -> Result<Vec<VarId>, CommandFailure> {
    let globs = GlobPatterns::new(patterns);
    let with_parameters = target.format().constants_are_free;
    let usual =
        |id: VarId, v: &FlatVariable| dae.is_shown(id) && (with_parameters || v.variability >= Variability::Discrete);
    let wanted = |id: VarId, v: &FlatVariable| {
        if globs.is_empty() {
            return usual(id, v);
        }
        // A wildcard leaves out hidden variables, but an exact name shows that the user wants it.
        globs.names(&v.name) || (globs.matches(&v.name) && usual(id, v))
    };
    let all = (0u32..).zip(&dae.variables).map(|(i, v)| (VarId(i), v));
    let chosen: Vec<VarId> = all.filter(|(id, v)| wanted(*id, v)).map(|(id, _)| id).collect();
    let missing = globs.unused(dae.variables.iter().map(|v| v.name.as_str()));
    // Only the first wrong pattern is reported.
    if let Some(problem) = missing.iter().map(|name| unknown(dae, name)).reduce(|first, _| first) {
        return Err(problem.into());
    }
    Ok(chosen)
}

/// The diagnostic for a pattern without a match, with a similar name when there is one.
fn unknown(dae: &Dae, pattern: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::BadArgument, format!("`--variables {pattern}` matches no variable"));
    match nearest(pattern, dae.variables.iter().filter(|v| !v.hidden).map(|v| v.name.as_str())) {
        Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
        None => diagnostic.help("brackets are literal; `*` stands for any text: 'v[*].p'"),
    }
}
