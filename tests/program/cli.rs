//! The command line, page by page: each `tests/cli/*.trycmd` holds commands and what they must say.

#[test]
fn pages() {
    trycmd::TestCases::new().case("tests/cli/*.trycmd");
}
