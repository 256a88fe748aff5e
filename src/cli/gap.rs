//! `bramah gap`

use clap::Args;
use std::path::PathBuf;

use super::messages::Messages;
use super::recorder::write_text;
use super::{DiskWorld, Ending, Failure, files};
use crate::diag::{Checked, Code, Diagnostic};
use crate::gap::circuit::circuit;
use crate::gap::diagnose::{Stage, Trouble, search};
use crate::gap::effects::catalogue;
use crate::gap::fixed::corrected;
use crate::gap::hypotheses::{self, Free, Hypothesis, Signal};
use crate::gap::report::report;
use crate::gap::study::question;
use crate::gap::words::words;
use crate::study::{Knowledge, Study};

/// Find where model and bench part, and which missing effect explains it
#[derive(Args, Debug)]
#[command(after_help = "\
The verdict goes to stdout as JSON (or into the file given), the words to stderr. Recordings of role `held` are read
last, when everything has been decided, and say how far the gap shrinks.

Examples:
  bramah gap study.toml --data bench/                       the diagnosis
  bramah gap study.toml --data bench/ -o verdict.json
  bramah gap study.toml --data bench/ --write-model fixed.mo --report report.html
  bramah gap study.toml --list      what the network of the study's model could lack, and where

Exit status: 0 whatever the verdict, 1 the nominal model is wrong, 2 a study, file or column that cannot be used.")]
pub(super) struct GapArgs {
    /// The study
    #[arg(value_name = "STUDY.toml")]
    study: PathBuf,
    /// The folder of the recordings [default: that of the study]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// The verdict as JSON, `-` for stdout
    #[arg(short, long, visible_alias = "output-file", default_value = "-", value_name = "FILE")]
    output: String,
    /// The corrected model, class `Fixed`, with every class it needs in one Modelica file, `-` for stdout
    #[arg(long, value_name = "FILE")]
    write_model: Option<String>,
    /// What was found as one HTML page, `-` for stdout
    #[arg(long, value_name = "FILE")]
    report: Option<String>,
    /// List every effect at every place where it fits, and stop
    #[arg(long)]
    list: bool,
}

pub(super) fn run(args: &GapArgs, messages: &mut Messages) -> Result<Ending, Failure> {
    let study = said(Study::read(&DiskWorld, &args.study, &mut messages.sources), messages)?;
    if args.list {
        files::print(&listed(&proposed(&study, messages)?))?;
        return Ok(Ending::Fine);
    }
    diagnose(args, &study, messages)
}

fn diagnose(args: &GapArgs, study: &Study, messages: &mut Messages) -> Result<Ending, Failure> {
    let begun = std::time::Instant::now();
    let data = args.data.as_deref();
    let question = question(&DiskWorld, study, data, &mut messages.sources).map_err(|u| {
        if let Some(sources) = u.sources {
            messages.sources = sources;
        }
        Failure { diagnostics: u.diagnostics }
    })?;
    messages.say(&question.diagnostics);
    let stages = Stages::new();
    let search = search(&question.problem, &mut |stage| stages.show(stage)).map_err(|t| trouble(&t))?;
    stages.show(Stage::Held);
    let held = question.held(data, &mut messages.sources).map_err(|diagnostics| Failure { diagnostics })?;
    let verdict = search.verdict(&question.problem, &held, begun.elapsed().as_secs_f64());
    stages.clear();
    if held.is_empty() {
        messages.remark("There are no held recordings: the gap is that on the recordings that were used.");
    }
    messages.remark(words(&verdict).trim_end());
    let text = serde_json::to_string_pretty(&verdict).expect("numbers and texts always serialize");
    write_text(&args.output, &format!("{text}\n"))?;
    if let Some(file) = &args.write_model {
        write_text(file, &said(corrected(&question.problem, &search), messages)?)?;
    }
    if let Some(file) = &args.report {
        write_text(file, &report(&question.problem, &search, &verdict, &held))?;
    }
    Ok(Ending::Fine)
}

/// What stops a diagnosis: the nominal model does not compile, or cannot follow the recordings.
fn trouble(trouble: &Trouble) -> Failure {
    match trouble {
        Trouble::Model(diagnostics) => Failure { diagnostics: diagnostics.clone() },
        Trouble::Diverges(time, why) => {
            let text = format!("the nominal model cannot follow the recordings: at {time} s {why}");
            Diagnostic::new(Code::BadData, text)
                .help("check the units and signs of the inputs in the study, and the model's start values")
                .into()
        }
    }
}

/// The stages of a diagnosis as a line on a terminal.
struct Stages {
    bar: Option<indicatif::ProgressBar>,
}

impl Stages {
    fn new() -> Self {
        let terminal = std::io::IsTerminal::is_terminal(&std::io::stderr());
        let bar = terminal.then(indicatif::ProgressBar::new_spinner);
        if let Some(bar) = &bar {
            bar.enable_steady_tick(std::time::Duration::from_millis(200));
        }
        Stages { bar }
    }

    fn show(&self, stage: Stage) {
        let Some(bar) = &self.bar else { return };
        bar.set_message(match stage {
            Stage::Anchor => "noise, tolerances and disturbances".to_string(),
            Stage::Locate => "places".to_string(),
            Stage::Screen(n) => format!("all hypotheses for effect {n}"),
            Stage::Refine(n) => format!("the best of them for effect {n}"),
            Stage::Held => "held recordings".to_string(),
        });
    }

    fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
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
