//! `bramah new`: writes a commented circuit and experiment, or a nominal model and a study, to start from.
//!
//! A folder name enters; two files leave. The class is named after the folder. The templates in `new/` contain
//! `{{Name}}` for the class and `{{name}}` for its name in lower case.

use std::path::{Path, PathBuf};

use clap::Args;

use super::files::{access, write};
use super::messages::MessageReporter;
use super::{CommandFailure, CommandStatus};
use bramah_syntax::diag::{Code, Diagnostic};

/// Template of the circuit.
const CIRCUIT: &str = include_str!("new/circuit.mo");
/// Template of the experiment file.
const EXPERIMENT: &str = include_str!("new/experiment.toml");
/// Template of the nominal model for a study.
const RIG: &str = include_str!("new/rig.mo");
/// Template of the study file.
const STUDY: &str = include_str!("new/study.toml");

/// Begin a circuit, or a study of recordings, every line explained
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bramah new press         writes press/Press.mo and press/press.toml
  cd press && bramah simulate press.toml
  bramah new rig --study   writes rig/Rig.mo and rig/rig.toml: a nominal model and a study for your recordings")]
pub(super) struct NewArgs {
    /// The folder to write into; it is made if it does not exist
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// A study for `bramah gap` and `bramah identify`, every line explained, and a nominal model with inputs
    #[arg(long)]
    study: bool,
}

/// Writes the files and prints the next commands.
///
/// `Err`: the folder name gives no class name, a file exists already, or the folder cannot be written.
pub(super) fn run(args: &NewArgs, messages: &MessageReporter) -> Result<CommandStatus, CommandFailure> {
    let class = class_name(&args.folder)?;
    let name = class.to_lowercase();
    let (model, table) = if args.study { (RIG, STUDY) } else { (CIRCUIT, EXPERIMENT) };
    let files = [(args.folder.join(format!("{class}.mo")), model), (args.folder.join(format!("{name}.toml")), table)];
    // Both are checked before either is written, so that nothing of the user is overwritten or mixed.
    for (path, _) in &files {
        if path.exists() {
            let text = format!("`{}` is already there; nothing was written", path.display());
            return Err(CommandFailure::new(Code::FileAccess, text));
        }
    }
    std::fs::create_dir_all(&args.folder).map_err(|e| access(&args.folder, "made", &e))?;
    for (path, text) in &files {
        write(path, text.replace("{{Name}}", &class).replace("{{name}}", &name).as_bytes())?;
        messages.remark(&format!("wrote {}", path.display()));
    }
    let folder = args.folder.display();
    if args.study {
        messages.remark(&format!(
            "next:\n  bramah gap {folder}/{name}.toml --list\n  put your recordings beside it, name their columns in \
             {folder}/{name}.toml, then\n  bramah gap {folder}/{name}.toml --report {folder}/gap.html"
        ));
        return Ok(CommandStatus::Fine);
    }
    messages.remark(&format!(
        "next:\n  bramah check {folder}/{class}.mo\n  bramah simulate {folder}/{name}.toml\n  \
         bramah plot {folder}/{name}.csv -o {folder}/report.html"
    ));
    Ok(CommandStatus::Fine)
}

/// The class name for a folder: words joined, each with a capital letter, such as `MyPress` for `my-press`.
///
/// `Err`: the name does not begin with a letter.
fn class_name(folder: &Path) -> Result<String, CommandFailure> {
    // `.` and `..` have no name of their own, so the path is made absolute.
    let absolute = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let last = absolute.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let words = last.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty());
    // Only ASCII letters and digits are left in a word, so slicing after one byte is safe.
    let name: String = words.map(|w| w[..1].to_uppercase() + &w[1..]).collect();
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return Ok(name);
    }
    let text = format!("`{}` gives no name for a class", folder.display());
    Err(Diagnostic::new(Code::BadArgument, text).help("choose a folder name that begins with a letter").into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        assert_eq!(class_name(Path::new("a/my-press_2")).unwrap(), "MyPress2");
        assert_eq!(class_name(Path::new("press/")).unwrap(), "Press");
        assert!(class_name(Path::new("9")).is_err());
        assert!(class_name(Path::new("/")).is_err());
    }

    #[test]
    fn the_study_ties_to_its_model() {
        let named = |text: &str| text.replace("{{Name}}", "Rig").replace("{{name}}", "rig");
        let mut world = bramah_syntax::world::MemoryWorld::single("Rig.mo", named(RIG));
        world.add("rig.toml", named(STUDY));
        let mut sources = bramah_syntax::diag::Sources::default();
        let study = bramah_analysis::study::Study::read(&world, Path::new("rig.toml"), &mut sources).value.unwrap();
        let flat = bramah_model::compile::flatten(&world, &study.request()).value.unwrap().flat;
        let bound = study.bind(&flat);
        assert_eq!(bound.diagnostics, []);
        assert_eq!(bound.value.unwrap().parameters.len(), 4);
    }

    #[test]
    fn the_experiment_can_be_read() {
        let mut sources = bramah_syntax::diag::Sources::default();
        let file = sources.add("x.toml", EXPERIMENT.replace("{{Name}}", "X").replace("{{name}}", "x"));
        let checked = bramah_analysis::experiment::parse(&sources, file);
        assert_eq!(checked.diagnostics, []);
    }
}
