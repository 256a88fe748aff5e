//! The `bramah` command.

fn main() {}
