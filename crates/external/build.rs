//! What a unit logs comes by a C function with variable arguments, which Rust cannot define.

fn main() {
    #[cfg(feature = "fmi")]
    {
        println!("cargo:rerun-if-changed=src/mockup/logger.c");
        cc::Build::new().file("src/mockup/logger.c").compile("bramah_mockup_logger");
    }
}
