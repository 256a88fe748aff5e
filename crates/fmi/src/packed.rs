//! The texts of a model in one file: recorded while it is compiled for the export, read again in the unit.
//!
//! [`ReadRecorder`] is a `World` that notes every file that the compiler reads. [`PackedRequest`] holds them with the
//! request and is itself a `World`, so that the unit compiles without access to the disk.

use bramah_model::compile::Request;
use bramah_model::instance::Override;
use bramah_syntax::world::World;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The name of the file in the folder `resources/` of a unit.
pub const FILE: &str = "model.json";

/// A compile request with every file and folder that was read for it, under the original paths.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PackedRequest {
    /// The token that ties the texts to `modelDescription.xml`.
    pub token: String,
    /// The file, package or class to compile.
    source: String,
    /// The class in it; `None` for the one that can run.
    model: Option<String>,
    /// Values of parameters from the export, by name.
    set: Vec<(String, String)>,
    /// Folders of libraries.
    libraries: Vec<String>,
    /// Patterns of variables that are outputs besides the model's own.
    pub outputs: Vec<String>,
    /// Texts by path.
    files: BTreeMap<String, String>,
    /// Entries of folders by path, each with whether it is a folder.
    folders: BTreeMap<String, Vec<(String, bool)>>,
}

impl PackedRequest {
    /// The request to compile, with this as its world.
    pub fn request(&self) -> Request {
        Request {
            source: self.source.clone().into(),
            model: self.model.clone(),
            overrides: self.set.iter().map(|(n, v)| Override { name: n.clone(), value: v.clone() }).collect(),
            libraries: self.libraries.iter().map(PathBuf::from).collect(),
            ..Request::default()
        }
    }

    /// The content of the file.
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("texts always serialize")
    }

    /// Parses what [`PackedRequest::json`] has written.
    ///
    /// # Errors
    /// The text is no such JSON.
    pub fn from_json(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|why| why.to_string())
    }
}

impl World for PackedRequest {
    /// The packed text of a file. `Err`: the export did not read this file.
    fn read(&self, path: &Path) -> Result<String, String> {
        let missing = || format!("the unit holds no file `{}`", path.display());
        self.files.get(&name(path)).cloned().ok_or_else(missing)
    }

    /// The packed entries of a folder. `None`: the export did not list it.
    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        self.folders.get(&name(path)).cloned()
    }
}

/// The path as a key. Slashes are uniform, so that a unit made on Windows works elsewhere.
fn name(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}

/// A world that passes every access on and notes what was read.
pub struct ReadRecorder<'a> {
    /// The world that is read.
    base: &'a dyn World,
    /// What was read. A mutex, because a world is shared between threads.
    seen: Mutex<PackedRequest>,
}

impl<'a> ReadRecorder<'a> {
    /// A recorder over `base` that has noted nothing yet.
    pub fn new(base: &'a dyn World) -> Self {
        ReadRecorder { base, seen: Mutex::default() }
    }

    /// Everything that was read, together with the request, the outputs and the token.
    pub fn packed(self, request: &Request, outputs: &[String], token: &str) -> PackedRequest {
        let mut packed = self.seen.into_inner().unwrap_or_else(PoisonError::into_inner);
        packed.source = name(&request.source);
        packed.model.clone_from(&request.model);
        packed.set = request.overrides.iter().map(|o| (o.name.clone(), o.value.clone())).collect();
        packed.libraries = request.libraries.iter().map(|l| name(l)).collect();
        packed.outputs = outputs.to_vec();
        token.clone_into(&mut packed.token);
        packed
    }
}

impl World for ReadRecorder<'_> {
    /// Reads a text and notes it.
    fn read(&self, path: &Path) -> Result<String, String> {
        let text = self.base.read(path)?;
        // Only files that were read successfully; a missing file is missing in the unit too.
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).files.insert(name(path), text.clone());
        Ok(text)
    }

    /// Refuses binary files, so that the export fails with a clear message.
    fn bytes(&self, _: &Path) -> Result<Vec<u8>, String> {
        // Binary files are units of other tools, and a unit cannot hold another one.
        Err("a unit cannot hold another one: export a circuit without it".to_owned())
    }

    /// Lists a folder and notes its entries.
    fn list(&self, path: &Path) -> Option<Vec<(String, bool)>> {
        let entries = self.base.list(path)?;
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).folders.insert(name(path), entries.clone());
        Some(entries)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_circuit::Simulation;
    use bramah_syntax::world::MemoryWorld;

    #[test]
    fn a_package_is_compiled_again_from_what_was_read() {
        let mut world = MemoryWorld::default();
        world.add("lib/P/package.mo", "package P end P;");
        world.add(
            "lib/P/Leak.mo",
            "within P; block Leak parameter Real k = 2; input Real u; output Real y = k*u; end Leak;",
        );
        world.add("lib/P/Unused.mo", "within P; block Unused end Unused;");
        world.add("M.mo", "model M P.Leak leak; equation leak.u = time; end M;");
        let request = Request {
            source: "M.mo".into(),
            libraries: vec!["lib".into()],
            overrides: vec![Override { name: "leak.k".into(), value: "5".into() }],
            ..Request::default()
        };
        let recorder = ReadRecorder::new(&world);
        Simulation::compile(&recorder, &request).unwrap();
        let text = recorder.packed(&request, &[], "t").json();
        assert!(!text.contains("Unused end"), "{text}");
        let packed = PackedRequest::from_json(&text).unwrap();
        let again = Simulation::compile(&packed, &packed.request()).unwrap();
        assert_eq!(again.get("leak.k").unwrap(), 5.0);
        assert!(PackedRequest::from_json("{").is_err());
    }
}
