//! The pages of the codes are packed into the command: a change of theirs is a change of the crate.

fn main() {
    println!("cargo:rerun-if-changed=docs/errors");
}
