//! The symbols of components are packed into the binary: a change of theirs is a change of the crate.

fn main() {
    println!("cargo:rerun-if-changed=crates/model/src/network/symbols");
}
