//! The component library and the models are packed into the binary: a change of theirs is a change of the crate.

fn main() {
    for folder in ["components", "models", "docs/errors", "src/plot/network/symbols"] {
        println!("cargo:rerun-if-changed={folder}");
    }
    #[cfg(feature = "fmi")]
    {
        println!("cargo:rerun-if-changed=src/external/mockup/logger.c");
        cc::Build::new().file("src/external/mockup/logger.c").compile("bramah_mockup_logger");
    }
}
