//! The component library and the models are packed into the binary: a change of theirs is a change of the crate.

fn main() {
    for folder in ["components", "models"] {
        println!("cargo:rerun-if-changed={folder}");
    }
}
