//! `bramah export`: writes a circuit as a functional mock-up unit (FMU), a zip archive.
//!
//! A model enters; one `.fmu` file leaves. It holds the runtime library, the texts from which the circuit is compiled
//! when the unit starts, the description and a page of documentation. The crate `bramah_fmi` makes the description;
//! this module packs the archive.

use std::fmt::Write as _;
use std::hash::Hasher;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use rustc_hash::FxHasher;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::files::{self, NewFile};
use super::messages::MessageReporter;
use super::model::{described, request};
use super::request::ModelArgs;
use super::{CommandFailure, CommandStatus};
use bramah_circuit::Simulation;
use bramah_fmi::description::{self, FmiVersion, IDENTIFIER};
use bramah_fmi::{FmiCausality, FmiInterface, PackedRequest, ReadRecorder, packed};
use bramah_plot::network;
use bramah_plot::svg::escape;
use bramah_results::number;
use bramah_syntax::diag::{Code, Diagnostic, nearest};
use bramah_syntax::world::DiskWorld;

/// Write a circuit as a functional mock-up unit (FMI, Co-Simulation)
#[derive(Args, Debug)]
#[command(after_help = "\
The unit runs on a machine with neither bramah nor Rust. It holds a library, the texts that the circuit was made of, a
description, and a page with the network and its parameters. Inputs of the circuit are inputs, its outputs outputs; with
--outputs other variables are outputs too. Parameters on which the structure depends keep the value that they have here.

Examples:
  bramah export Press.mo -o press.fmu --outputs line.p,pump.Q_A
  bramah export Axis.mo --fmi 2 --set load.m='120 kg' -o axis.fmu
  bramah export ServoPump.System -o system.fmu

Exit status: 0 fine; 1 the model is wrong; 2 bad arguments or files.")]
pub(super) struct ExportArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// Where to write it [default: CLASS.fmu]
    #[arg(short, long, value_name = "FMU")]
    output_file: Option<PathBuf>,
    /// Version of the standard
    #[arg(long, value_enum, default_value_t = FmiVersionArg::Three)]
    fmi: FmiVersionArg,
    /// Variables that are outputs, such as 'line.p,pump.*'; may be repeated
    #[arg(long, value_name = "GLOB,...")]
    outputs: Vec<String>,
    /// The library for the unit [default: that beside this command]
    #[arg(long, value_name = "FILE")]
    runtime: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FmiVersionArg {
    /// FMI 2.0
    #[value(name = "2")]
    Two,
    /// FMI 3.0
    #[value(name = "3")]
    Three,
}

/// Runs the subcommand. `Err`: the model is wrong, an output pattern matches nothing, or the runtime library is
/// missing.
///
/// The steps in order: find the runtime library, compile while noting what is read, derive the variables, pack, write.
pub(super) fn run(args: &ExportArgs, messages: &mut MessageReporter) -> Result<CommandStatus, CommandFailure> {
    // A missing library is reported before the model is compiled.
    let library = runtime(args.runtime.as_deref())?;
    let experiment = args.model.experiment(None, messages)?;
    let request = request(&experiment)?;
    // Notes every file that the compiler reads; these files go into the unit.
    let recorder = ReadRecorder::new(&DiskWorld);
    let simulation = match Simulation::compile(&recorder, &request) {
        Ok(simulation) => simulation,
        Err(error) => {
            messages.sources = (*error.sources).clone();
            return Err(CommandFailure { diagnostics: error.diagnostics });
        }
    };
    messages.sources = simulation.sources().clone();
    messages.say(&simulation.diagnostics);
    let interface = FmiInterface::new(&simulation, &args.outputs).map_err(|name| unknown(&simulation, &name))?;
    // The token is a hash of the packed texts, so it is computed with an empty one and then filled in.
    let mut packed = recorder.packed(&request, &args.outputs, "");
    packed.token = token(&packed);
    let path = args.output_file.clone().unwrap_or_else(|| format!("{}.fmu", interface.class).into());
    files::ending(&path, "a unit", &["fmu"])?;
    let description = described(&request, &interface.class);
    let unit = FmuContents { interface: &interface, packed: &packed, description, fmi: args.fmi };
    // The archive is built in memory first, so that an error leaves no file.
    let bytes = unit.write(&library, &network::write(&simulation.model().graph, &interface.class))?;
    let mut file = NewFile::create(&path)?;
    file.write_all(&bytes).map_err(|e| files::access(&path, "written", &e))?;
    file.finish()?;
    let count = |c: FmiCausality| interface.ports.iter().filter(|p| p.causality == c).count();
    let kinds = match interface.alone {
        None => "Co-Simulation and Model Exchange".to_owned(),
        Some(why) => format!("Co-Simulation (no Model Exchange: {why})"),
    };
    messages.remark(&format!(
        "wrote {}: FMI {}, {}, {} parameters, {} inputs, {} outputs, {} MB",
        path.display(),
        if args.fmi == FmiVersionArg::Two { "2.0" } else { "3.0" },
        kinds,
        count(FmiCausality::Parameter),
        count(FmiCausality::Input),
        count(FmiCausality::Output),
        number::rounded(bytes.len() as f64 / 1e6, 2)
    ));
    Ok(CommandStatus::Fine)
}

/// The failure for a pattern of `--outputs` without a match.
fn unknown(simulation: &Simulation, pattern: &str) -> CommandFailure {
    let d = Diagnostic::new(Code::BadArgument, format!("`--outputs {pattern}` matches no variable"));
    let names: Vec<String> = simulation.variables().into_iter().map(|s| s.name).collect();
    match nearest(pattern, names.iter().map(String::as_str)) {
        Some(near) => d.help(format!("did you mean `{near}`?")),
        None => d,
    }
    .into()
}

/// The token that ties the description to the texts: a hash in the form of a GUID, the same for the same unit.
fn token(packed: &PackedRequest) -> String {
    // Two hashes with different seeds give the 128 bits of a GUID.
    let mut words = [0_u64; 2];
    for (seed, word) in (1..).zip(&mut words) {
        let mut hasher = FxHasher::default();
        hasher.write_u64(seed);
        hasher.write(packed.json().as_bytes());
        // Another version may compile the same texts to another unit.
        hasher.write(env!("CARGO_PKG_VERSION").as_bytes());
        *word = hasher.finish();
    }
    let digits = format!("{:016x}{:016x}", words[0], words[1]);
    // Groups of 8, 4, 4, 4 and 12 digits.
    let parts = [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]];
    format!("{{{}}}", parts.join("-"))
}

/// The runtime library of units. It is searched beside the command (where a build puts it) and in `../lib` (where an
/// installation puts it).
///
/// `given` is the file of `--runtime`; it is then the only candidate.
///
/// `Err`: it is in none of these places.
fn runtime(given: Option<&Path>) -> Result<Vec<u8>, CommandFailure> {
    let candidates: Vec<PathBuf> = match given {
        Some(path) => vec![path.to_owned()],
        None => {
            let here = std::env::current_exe().ok().and_then(|p| p.parent().map(Path::to_owned)).unwrap_or_default();
            let name = format!("{}bramah_fmu{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
            vec![here.join(&name), here.join("../lib/bramah").join(&name), here.join("../lib").join(&name)]
        }
    };
    if let Some(bytes) = candidates.iter().find_map(|path| std::fs::read(path).ok()) {
        return Ok(bytes);
    }
    let text = format!("the library for units is not there: `{}`", candidates[0].display());
    let d = Diagnostic::new(Code::FileAccess, text);
    Err(d
        .help("release archives have it; from source: `cargo build --release -p bramah-fmu`, then `--runtime FILE`")
        .into())
}

/// Everything that goes into the archive.
struct FmuContents<'a> {
    /// The variables of the unit.
    interface: &'a FmiInterface,
    /// The texts and the request.
    packed: &'a PackedRequest,
    /// Description of the class.
    description: String,
    /// Version of the standard.
    fmi: FmiVersionArg,
}

impl FmuContents<'_> {
    /// The archive as bytes. `library` is the runtime, `picture` the network as SVG.
    ///
    /// The entries are the description, the packed texts, the documentation page, the licences and the library.
    fn write(&self, library: &[u8], picture: &str) -> Result<Vec<u8>, CommandFailure> {
        let failed = |e: &dyn std::fmt::Display| {
            CommandFailure::new(Code::FileAccess, format!("the unit cannot be packed: {e}"))
        };
        let version = if self.fmi == FmiVersionArg::Two { FmiVersion::Two } else { FmiVersion::Three };
        let description = description::write(self.interface, version, &self.packed.token, &self.description);
        // The two versions of the standard prescribe different names for the first page.
        let page = if self.fmi == FmiVersionArg::Two { "documentation/_main.html" } else { "documentation/index.html" };
        let licences = [include_str!("../../LICENSE-MIT"), include_str!("../../LICENSE-APACHE")].join("\n\n");
        let mut zip = ZipWriter::new(std::io::Cursor::new(Vec::new()));
        // No time stamps, so that the same circuit gives the same bytes.
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(zip::DateTime::default())
            .unix_permissions(0o644);
        let (texts, page_text) = (self.packed.json(), self.page(picture));
        let entries: [(String, &[u8], u32); 5] = [
            ("modelDescription.xml".to_owned(), description.as_bytes(), 0o644),
            (format!("resources/{}", packed::FILE), texts.as_bytes(), 0o644),
            (page.to_owned(), page_text.as_bytes(), 0o644),
            ("documentation/licenses/license.txt".to_owned(), licences.as_bytes(), 0o644),
            // Some importers load the library from the extracted archive and need the permission to execute.
            (self.binary(), library, 0o755),
        ];
        for (name, bytes, mode) in entries {
            zip.start_file(name, options.unix_permissions(mode)).map_err(|e| failed(&e))?;
            zip.write_all(bytes).map_err(|e| failed(&e))?;
        }
        Ok(zip.finish().map_err(|e| failed(&e))?.into_inner())
    }

    /// The path of the library in the archive, as the standard prescribes for this machine.
    ///
    /// Version 2 names the folder by system and word size, version 3 by processor and system.
    fn binary(&self) -> String {
        let (arch, os) = (std::env::consts::ARCH, std::env::consts::OS);
        let folder = match (self.fmi, os) {
            (FmiVersionArg::Two, "macos") => "darwin64".to_owned(),
            (FmiVersionArg::Two, "windows") => "win64".to_owned(),
            (FmiVersionArg::Two, _) => "linux64".to_owned(),
            (FmiVersionArg::Three, "macos") => format!("{arch}-darwin"),
            (FmiVersionArg::Three, os) => format!("{arch}-{os}"),
        };
        format!("binaries/{folder}/{IDENTIFIER}{}", std::env::consts::DLL_SUFFIX)
    }

    /// The documentation page: the network, and tables of parameters, inputs and outputs.
    ///
    /// Values are rounded to nine digits. All texts of the model are escaped.
    fn page(&self, picture: &str) -> String {
        let class = escape(&self.interface.class);
        let mut out = format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{class}</title>\n<style>body {{ font: 14px \
             sans-serif; margin: 24px; max-width: 1100px }} svg {{ max-width: 100%; height: auto }} td, th {{ padding: 2px 14px \
             2px 0; text-align: left }}</style></head>\n<body><h1>{class}</h1>\n<p>{}</p>\n{picture}\n",
            escape(&self.description)
        );
        let parts = [
            ("Parameters", FmiCausality::Parameter),
            ("Inputs", FmiCausality::Input),
            ("Outputs", FmiCausality::Output),
        ];
        for (title, causality) in parts {
            let ports: Vec<_> = self.interface.ports.iter().filter(|p| p.causality == causality).collect();
            if ports.is_empty() {
                continue;
            }
            let _ = writeln!(out, "<h2>{title}</h2>\n<table><tr><th>name<th>value<th>unit<th>description</tr>");
            for p in ports {
                let value = p.start.map_or_else(String::new, |v| number::rounded(v, 9));
                let cells = [&p.signal.name, &value, &p.signal.unit, &p.signal.description];
                let cells: String = cells.iter().map(|c| format!("<td>{}", escape(c))).collect();
                let _ = writeln!(out, "<tr>{cells}</tr>");
            }
            out.push_str("</table>\n");
        }
        let _ = write!(out, "<p>Written by bramah {}.</p>\n</body></html>\n", env!("CARGO_PKG_VERSION"));
        out
    }
}
