//! Units made on the spot: a model in C is compiled, and packed with a description for FMI 2.0 or 3.0.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fmi {
    Two,
    Three,
}

/// A variable: name, value reference, causality, type, attributes. Types are those of FMI 3.0.
pub type Variable = (&'static str, u32, &'static str, &'static str, &'static str);

/// What a unit says of itself.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    pub name: &'static str,
    /// `CoSimulation`, `ModelExchange` with their attributes.
    pub kinds: &'static [(&'static str, &'static str)],
    pub variables: &'static [Variable],
    /// Derivatives by their value references.
    pub derivatives: &'static [u32],
    pub indicators: usize,
}

const BOTH: &[(&str, &str)] =
    &[("ModelExchange", ""), ("CoSimulation", "canHandleVariableCommunicationStepSize=\"true\"")];

pub const OSCILLATOR: Unit = Unit {
    name: "oscillator",
    kinds: &[("ModelExchange", "DERIVATIVES"), ("CoSimulation", "")],
    variables: &[
        ("f", 0, "input", "Float64", r#"unit="N" start="0""#),
        ("m", 1, "parameter", "Float64", r#"unit="kg" start="2" min="0""#),
        ("c", 2, "parameter", "Float64", r#"start="200""#),
        ("d", 3, "parameter", "Float64", r#"start="3""#),
        ("x0", 4, "parameter", "Float64", r#"unit="mm" start="100""#),
        ("power", 5, "output", "Float64", r#"unit="W""#),
        ("x", 6, "output", "Float64", r#"unit="m""#),
        ("v", 7, "output", "Float64", r#"unit="m/s""#),
        ("der(x)", 8, "local", "Float64", r#"derivative="6""#),
        ("der(v)", 9, "local", "Float64", r#"derivative="7""#),
    ],
    derivatives: &[8, 9],
    indicators: 0,
};

pub const BALL: Unit = Unit {
    name: "ball",
    kinds: BOTH,
    variables: &[
        ("g", 0, "parameter", "Float64", r#"start="9.81""#),
        ("e", 1, "parameter", "Float64", r#"start="0.7""#),
        ("bounces", 2, "output", "Int32", ""),
        ("lies", 3, "output", "Boolean", ""),
        ("h", 4, "output", "Float64", r#"unit="m""#),
        ("v", 5, "output", "Float64", r#"unit="m/s""#),
        ("der(h)", 6, "local", "Float64", r#"derivative="4""#),
        ("der(v)", 7, "local", "Float64", r#"derivative="5""#),
    ],
    derivatives: &[6, 7],
    indicators: 1,
};

pub const TICKER: Unit = Unit {
    name: "ticker",
    kinds: BOTH,
    variables: &[
        ("u", 0, "input", "Float64", r#"start="0""#),
        ("go", 1, "input", "Boolean", r#"start="false""#),
        ("period", 2, "parameter", "Float64", r#"unit="s" start="0.1""#),
        ("gain", 3, "parameter", "Float64", r#"start="2""#),
        ("y", 4, "output", "Float64", r#"DISCRETE"#),
        ("ticks", 5, "output", "Int32", ""),
        ("on", 6, "output", "Boolean", ""),
        ("through", 7, "output", "Float64", ""),
    ],
    derivatives: &[],
    indicators: 0,
};

pub const CONTROLLER: Unit = Unit {
    name: "controller",
    kinds: &[("CoSimulation", "")],
    variables: &[
        ("set", 0, "input", "Float64", r#"unit="bar" start="0""#),
        ("measured", 1, "input", "Float64", r#"unit="bar" start="0""#),
        ("enable", 2, "input", "Boolean", r#"start="true""#),
        ("Kp", 3, "parameter", "Float64", r#"start="0.05""#),
        ("Ti", 4, "parameter", "Float64", r#"unit="s" start="0.2""#),
        ("u", 5, "output", "Float64", r#"unit="1""#),
        ("scans", 6, "output", "Int32", ""),
    ],
    derivatives: &[],
    indicators: 0,
};

pub const FAULTY: Unit = Unit {
    name: "faulty",
    kinds: BOTH,
    variables: &[
        ("fault", 0, "parameter", "Int32", r#"start="0""#),
        ("y", 1, "output", "Float64", ""),
        ("x", 2, "local", "Float64", ""),
        ("der(x)", 3, "local", "Float64", r#"derivative="2""#),
    ],
    derivatives: &[3],
    indicators: 0,
};

pub const ARRAYS: Unit = Unit {
    name: "arrays",
    kinds: BOTH,
    variables: &[
        ("u", 0, "input", "Float64", "start=\"0\" DIMS 3"),
        ("A", 10, "parameter", "Float64", "start=\"1 2 3 4 5 6\" DIMS 2 3"),
        ("y", 20, "output", "Float64", "DIMS 2"),
        ("mode", 30, "parameter", "Enumeration", r#"declaredType="Mode" start="1""#),
        ("block.offset[1]", 31, "parameter", "Float64", r#"start="0""#),
        ("step", 32, "parameter", "UInt8", r#"start="0""#),
        ("sign", 33, "parameter", "String", "positive"),
    ],
    derivatives: &[],
    indicators: 0,
};

impl Unit {
    /// `modelDescription.xml`.
    pub fn description(&self, fmi: Fmi) -> String {
        let (version, token) = if fmi == Fmi::Two { ("2.0", "guid") } else { ("3.0", "instantiationToken") };
        let name = self.name;
        let indicators =
            if fmi == Fmi::Two { format!(" numberOfEventIndicators=\"{}\"", self.indicators) } else { String::new() };
        let mut out = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"{version}\" modelName=\"{name}\" {token}=\"{{{name}}}\"{indicators}>\n"
        );
        for (kind, more) in self.kinds {
            let slopes =
                if fmi == Fmi::Two { "providesDirectionalDerivative" } else { "providesDirectionalDerivatives" };
            let more = more.replace("DERIVATIVES", &format!("{slopes}=\"true\""));
            let _ = writeln!(out, "<{kind} modelIdentifier=\"{name}\" {more}/>");
        }
        out += "<UnitDefinitions><Unit name=\"bar\"><BaseUnit kg=\"1\" m=\"-1\" s=\"-2\" factor=\"1e5\"/></Unit></UnitDefinitions>\n";
        if fmi == Fmi::Three {
            out += "<TypeDefinitions><EnumerationType name=\"Mode\"><Item name=\"normal\" value=\"1\"/><Item name=\"doubled\" value=\"2\"/></EnumerationType></TypeDefinitions>\n";
        }
        out += "<DefaultExperiment startTime=\"0\" stopTime=\"1\" stepSize=\"0.01\"/>\n<ModelVariables>\n";
        for v in self.variables {
            out += &self.variable(fmi, v);
        }
        out += "</ModelVariables>\n<ModelStructure>\n";
        out += &self.structure(fmi);
        out + "</ModelStructure>\n</fmiModelDescription>\n"
    }

    fn variable(&self, fmi: Fmi, (name, reference, causality, ty, attributes): &Variable) -> String {
        let (attributes, dims) = attributes.split_once("DIMS").unwrap_or((attributes, ""));
        let discrete = attributes.contains("DISCRETE") || !ty.starts_with("Float") && *causality != "parameter";
        let attributes = attributes.replace("DISCRETE", "");
        let variability = match *causality {
            "parameter" => "fixed",
            _ if discrete => "discrete",
            _ => "continuous",
        };
        let common = format!(
            "name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\""
        );
        if *ty == "String" {
            return match fmi {
                Fmi::Two => format!("<ScalarVariable {common}><String start=\"{attributes}\"/></ScalarVariable>\n"),
                Fmi::Three => format!("<String {common}><Start value=\"{attributes}\"/></String>\n"),
            };
        }
        if fmi == Fmi::Three {
            let dims: String = dims.split_whitespace().map(|n| format!("<Dimension start=\"{n}\"/>")).collect();
            return format!("<{ty} {common} {attributes}>{dims}</{ty}>\n");
        }
        let ty = match *ty {
            "Float64" => "Real",
            "Boolean" => "Boolean",
            _ => "Integer",
        };
        // a derivative names its state by the place in the list
        let attributes = match attributes.split_once("derivative=\"") {
            Some((before, rest)) => {
                let (state, after) = rest.split_once('"').expect("quoted");
                format!("{before}derivative=\"{}\"{after}", 1 + self.at(state.parse().expect("a number")))
            }
            None => attributes,
        };
        format!("<ScalarVariable {common}><{ty} {attributes}/></ScalarVariable>\n")
    }

    fn at(&self, reference: u32) -> usize {
        self.variables.iter().position(|v| v.1 == reference).expect("it is listed")
    }

    fn structure(&self, fmi: Fmi) -> String {
        let outputs = self.variables.iter().filter(|v| v.2 == "output").map(|v| v.1);
        let list = |name: &str, references: Vec<u32>| -> String {
            references
                .into_iter()
                .map(|r| match fmi {
                    Fmi::Two => format!("<Unknown index=\"{}\"/>", 1 + self.at(r)),
                    Fmi::Three => format!("<{name} valueReference=\"{r}\"/>"),
                })
                .collect()
        };
        let (outputs, derivatives) =
            (list("Output", outputs.collect()), list("ContinuousStateDerivative", self.derivatives.to_vec()));
        match fmi {
            Fmi::Two => format!("<Outputs>{outputs}</Outputs><Derivatives>{derivatives}</Derivatives>\n"),
            // an indicator is a variable of its own, of which only the number counts here
            Fmi::Three => {
                format!("{outputs}{derivatives}{}\n", "<EventIndicator valueReference=\"0\"/>".repeat(self.indicators))
            }
        }
    }

    /// The unit's file in a folder, compiled with these definitions.
    pub fn make(&self, fmi: Fmi, folder: &Path, defines: &[&str]) -> PathBuf {
        let number = if fmi == Fmi::Two { 2 } else { 3 };
        let library = folder.join(format!("{}.so", self.name));
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/units").join(format!("{}.c", self.name));
        let compiled = Command::new("cc")
            .args(["-shared", "-fPIC", "-O1", "-o"])
            .arg(&library)
            .arg(format!("-DFMI={number}"))
            .args(defines)
            .arg(source)
            .arg("-lm")
            .output()
            .expect("the compiler that has built SUNDIALS");
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
        let platform = match (fmi, std::env::consts::OS, std::env::consts::ARCH) {
            (Fmi::Two, "linux", "x86_64") => "linux64".to_owned(),
            (Fmi::Two, "macos", _) => "darwin64".to_owned(),
            (_, "macos", arch) => format!("{arch}-darwin"),
            (_, os, arch) => format!("{arch}-{os}"),
        };
        let inside = format!("binaries/{platform}/{}{}", self.name, std::env::consts::DLL_SUFFIX);
        let code = std::fs::read(library).expect("just compiled");
        let path = folder.join(format!("{}{number}.fmu", self.name));
        let description = self.description(fmi);
        let files = [(inside.as_str(), code.as_slice()), ("modelDescription.xml", description.as_bytes())];
        std::fs::write(&path, archive(&files)).expect("writable");
        path
    }
}

/// A ZIP archive.
pub fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).expect("a name");
        zip.write_all(bytes).expect("in memory");
    }
    zip.finish().expect("in memory").into_inner()
}
