//! `bramah gap`

use clap::Args;
use std::path::PathBuf;

use super::messages::Messages;
use super::{DiskWorld, Ending, Failure, files};
use crate::diag::{Checked, Diagnostic};
use crate::gap::circuit::circuit;
use crate::gap::effects::catalogue;
use crate::gap::hypotheses::{self, Free, Hypothesis, Signal};
use crate::study::{Knowledge, Study};

/// Find where model and bench part, and which missing effect explains it
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah gap study.toml --list      what the network of the study's model could lack, and where

Exit status: 0 fine, 1 the nominal model is wrong, 2 a study, file or column that cannot be used.")]
pub(super) struct GapArgs {
    /// The study
    #[arg(value_name = "STUDY.toml")]
    study: PathBuf,
    /// List every effect at every place where it fits, and stop
    #[arg(long, required = true)]
    list: bool,
}

pub(super) fn run(args: &GapArgs, messages: &mut Messages) -> Result<Ending, Failure> {
    let study = said(Study::read(&DiskWorld, &args.study, &mut messages.sources), messages)?;
    let all = proposed(&study, messages)?;
    if args.list {
        files::print(&listed(&all))?;
    }
    Ok(Ending::Fine)
}

/// The value of a stage; its warnings are said, its errors end the command.
fn said<T>(checked: Checked<T>, messages: &Messages) -> Result<T, Failure> {
    match checked.value {
        Some(value) if !checked.diagnostics.iter().any(Diagnostic::is_error) => {
            messages.say(&checked.diagnostics);
            Ok(value)
        }
        _ => Err(Failure { diagnostics: checked.diagnostics }),
    }
}

/// All hypotheses that the study leaves in.
fn proposed(study: &Study, messages: &mut Messages) -> Result<Vec<Hypothesis>, Failure> {
    let request = study.request();
    let flattened = taken(crate::flatten(&DiskWorld, &request), messages)?;
    let bound = said(study.bind(&flattened.flat), messages)?;
    let scale = |s: &crate::study::BoundSignal| s.full_scale.unwrap_or(1.0);
    let signals: Vec<Signal> = bound
        .signals
        .iter()
        .map(|s| Signal { name: s.name.clone(), variable: variable(&flattened.flat, s.variable), scale: scale(s) })
        .collect();
    let free: Vec<Free> = bound.parameters.iter().filter_map(|p| drifting(&flattened.flat, p)).collect();
    let places = taken(circuit(&DiskWorld, &request), messages)?;
    let folder = study.effects.folder.as_ref().map(|f| study.folder.join(f));
    let effects = said(catalogue(&DiskWorld, folder.as_deref()), messages)?;
    let mut all = hypotheses::hypotheses(&places, &effects, &signals, &free);
    hypotheses::narrow(&mut all, &study.effects);
    Ok(all)
}

fn variable(flat: &crate::flat::FlatModel, v: crate::expr::VarId) -> String {
    flat.variables[v.index()].name.clone()
}

fn drifting(flat: &crate::flat::FlatModel, p: &crate::study::BoundParameter) -> Option<Free> {
    let v = &flat.variables[p.variable.index()];
    let nominal = v.binding.and_then(|b| flat.exprs.as_num(b)).unwrap_or(0.0);
    let sigma = match p.knowledge {
        Knowledge::Exact => return None,
        Knowledge::Relative(part) => part * nominal.abs(),
        Knowledge::Absolute(value) => value,
        Knowledge::Free => nominal.abs(),
    };
    Some(Free { name: p.name.clone(), nominal, sigma })
}

/// What a stage of the compiler gave; its errors end the command, with the texts they point into.
fn taken<T>(outcome: crate::Outcome<T>, messages: &mut Messages) -> Result<T, Failure> {
    let failed = outcome.diagnostics.iter().any(Diagnostic::is_error);
    match outcome.value.filter(|_| !failed) {
        Some(value) => Ok(value),
        None => {
            messages.sources = outcome.sources;
            Err(Failure { diagnostics: outcome.diagnostics })
        }
    }
}

/// One line a hypothesis, and a count.
fn listed(all: &[Hypothesis]) -> String {
    let mut text = String::new();
    for h in all {
        let places: Vec<&str> = h.places().iter().map(|p| p.place.as_str()).collect();
        text.push_str(&format!("{:<24} {:<44} {}\n", h.family, h.effect, places.join(" + ")));
    }
    text.push_str(&format!("{} hypotheses\n", all.len()));
    text
}
