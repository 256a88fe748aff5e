//! Functional mock-up units (FMUs) of other tools as components of a circuit.
//!
//! A unit becomes a Modelica class (`text`), compiled like any other, whose equations call the functions of the unit
//! (`functions`). `archive` unpacks its file, `description` reads what it says of itself, `native` calls its library,
//! `pool` keeps its instances. The crate `fmi` does much of this, but panics where a library lacks a function, unpacks
//! archives without limit and sends a unit's words to a log; so this is written by hand.

mod archive;
mod description;
mod functions;
mod native;
mod pool;
mod text;

pub use description::FmuInterface;
pub use functions::{FmuFunction, FmuOperation};
pub use pool::InstancePool;

use archive::FmuArchive;
use description::{FmuCapabilities, FmuDescription};
use native::FmuLibrary;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// Why a unit cannot be used, as the end of a sentence about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FmuError(String);

impl fmt::Display for FmuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<String> for FmuError {
    fn from(text: String) -> Self {
        FmuError(text)
    }
}

impl From<&str> for FmuError {
    fn from(text: &str) -> Self {
        FmuError(text.to_owned())
    }
}

/// A unit that was read, for one of its kinds. Its library is loaded when it is first needed: whoever only looks at a
/// circuit runs nothing of it.
pub struct ImportedFmu {
    bytes: Vec<u8>,
    description: FmuDescription,
    kind: FmuInterface,
    /// What it offers as this kind.
    offer: FmuCapabilities,
    code: OnceLock<Result<Arc<FmuLibrary>, FmuError>>,
}

impl ImportedFmu {
    /// Reads a unit. `kind` is `auto`, `cs` or `me`; `auto` is Co-Simulation where the unit has it.
    ///
    /// # Errors
    /// What is wrong with the file, or that it has no such kind.
    pub fn open(bytes: Vec<u8>, kind: &str) -> Result<Self, FmuError> {
        let mut archive = FmuArchive::open(&bytes)?;
        let description = FmuDescription::read(&archive.description()?)?;
        let has = |kind| description.offer(kind).is_some();
        let kind = match kind {
            "auto" if has(FmuInterface::CoSimulation) => FmuInterface::CoSimulation,
            "auto" if has(FmuInterface::ModelExchange) => FmuInterface::ModelExchange,
            "auto" => return Err("it offers neither Co-Simulation nor Model Exchange".into()),
            "cs" => FmuInterface::CoSimulation,
            "me" => FmuInterface::ModelExchange,
            other => return Err(format!("`kind` is \"auto\", \"cs\" or \"me\", not \"{other}\"").into()),
        };
        let offer = description.offer(kind).cloned();
        let offer = offer.ok_or_else(|| format!("it does not offer {}", kind.name()))?;
        archive.library(description.version, &offer.identifier)?;
        Ok(ImportedFmu { bytes, description, kind, offer, code: OnceLock::new() })
    }

    /// Its library, from the first use on.
    fn code(&self) -> Result<Arc<FmuLibrary>, FmuError> {
        let load = || {
            let unpacked = FmuArchive::open(&self.bytes)?.unpack(self.description.version, &self.offer.identifier)?;
            FmuLibrary::load(unpacked, &self.description).map(Arc::new)
        };
        self.code.get_or_init(load).clone()
    }

    /// Its class in Modelica, which extends `FMU` and has its name.
    pub fn class(&self) -> String {
        text::class(&self.description, self.kind)
    }

    /// What the equations of one component call. `texts` are the values of its texts, a line `INDEX=VALUE` each.
    pub fn pool(self: &Arc<Self>, texts: &str) -> InstancePool {
        let line = |l: &str| {
            let (index, value) = l.split_once('=')?;
            Some((index.parse().ok()?, value.to_owned()))
        };
        let texts: Vec<(usize, String)> = texts.lines().filter_map(line).collect();
        let known = self.description.texts();
        let texts = texts.into_iter().filter(|(i, _)| known.contains(i)).collect();
        InstancePool::new(self.clone(), texts)
    }
}
