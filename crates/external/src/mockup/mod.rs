//! Functional mock-up units (FMUs) of other tools as components of a circuit (FMI 2.0 and 3.0).
//!
//! The bytes of an FMU enter; a Modelica class and the functions that it calls leave. The crate `model` opens the unit
//! when it meets a component `FMU(file = ..)`.
//! `archive` unpacks the file, `description` reads its XML, `text` writes the class, `functions` are what its equations
//! call, `native` calls the library, `pool` keeps the instances.
//!
//! The published crate `fmi` does much of this. It panics if a library lacks a function, unpacks archives without limit
//! and sends the unit's messages to a log, so it is not used.

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

/// The reason why a unit cannot be used, as the end of a sentence about it.
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

/// A unit that was read, with the interface by which it is used.
/// Its library is loaded at the first use, so that showing or checking a circuit runs no foreign code.
pub struct ImportedFmu {
    /// The file.
    bytes: Vec<u8>,
    /// The content of its `modelDescription.xml`.
    description: FmuDescription,
    /// Co-Simulation or Model Exchange.
    kind: FmuInterface,
    /// The capabilities that it declares for this interface.
    offer: FmuCapabilities,
    /// The library, or why it cannot be loaded. Empty before the first use.
    code: OnceLock<Result<Arc<FmuLibrary>, FmuError>>,
}

impl ImportedFmu {
    /// Reads a unit. `kind` is `auto`, `cs` or `me`; `auto` means Co-Simulation if the unit has it, else Model
    /// Exchange.
    ///
    /// # Errors
    /// What is wrong with the file, that it lacks this interface, or that it has no library for this machine.
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
        // Only looked for, so that the message comes when the circuit is compiled and not in the run.
        archive.library(description.version, &offer.identifier)?;
        Ok(ImportedFmu { bytes, description, kind, offer, code: OnceLock::new() })
    }

    /// The library, which is unpacked and loaded at the first call.
    fn code(&self) -> Result<Arc<FmuLibrary>, FmuError> {
        let load = || {
            let unpacked = FmuArchive::open(&self.bytes)?.unpack(self.description.version, &self.offer.identifier)?;
            FmuLibrary::load(unpacked, &self.description).map(Arc::new)
        };
        self.code.get_or_init(load).clone()
    }

    /// The Modelica class of the unit, named `FMU`, which extends the class `FMU` at the root.
    pub fn class(&self) -> String {
        text::class(&self.description, self.kind)
    }

    /// The instances behind one component. `texts` are the values of its text parameters, one line `INDEX=VALUE` each.
    pub fn pool(self: &Arc<Self>, texts: &str) -> InstancePool {
        let line = |l: &str| {
            let (index, value) = l.split_once('=')?;
            Some((index.parse().ok()?, value.to_owned()))
        };
        let texts: Vec<(usize, String)> = texts.lines().filter_map(line).collect();
        let known = self.description.texts();
        // Indices that are no text parameters of this unit are dropped.
        let texts = texts.into_iter().filter(|(i, _)| known.contains(i)).collect();
        InstancePool::new(self.clone(), texts)
    }
}
