//! Sweeps in shares: what `docs/sweep.md` says about many machines.
#![allow(clippy::disallowed_methods, clippy::print_stderr, reason = "runs the command on files and says what it skips")]

use std::path::Path;
use std::process::{Command, Output};

const MODEL: &str = "model Press
  parameter Real k = 2; parameter Real d = 1;
  Real x(start = 1, fixed = true), v(start = 0, fixed = true);
equation
  der(x) = v; der(v) = -k*x - d*v;
end Press;";

const SWEEP: &str = r#"
file = "Press.mo"
stop-time = "2 s"

[sweep]
method = "latin-hypercube"
count = 14
seed = 3

[sweep.parameters]
k = { min = 1, max = 4 }
d = { min = 0.1, max = 2 }

[sweep.results]
least = "min(x)"
"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("Press.mo"), MODEL).expect("written");
    std::fs::write(folder.path().join("press.toml"), SWEEP).expect("written");
    folder
}

fn run(folder: &Path, program: &str, arguments: &[&str]) -> Output {
    Command::new(program).args(arguments).current_dir(folder).output().expect("starts")
}

/// What bramah says on stderr.
fn bramah(folder: &Path, arguments: &[&str]) -> String {
    let out = run(folder, env!("CARGO_BIN_EXE_bramah"), arguments);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.success(), "{said}");
    said
}

fn read(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).expect("written")
}

/// The whole sweep at once.
fn whole(folder: &Path) -> String {
    bramah(folder, &["sweep", "press.toml", "-o", "whole.csv"]);
    read(folder, "whole.csv")
}

#[test]
fn shares_join_to_the_whole() {
    let folder = folder();
    let folder = folder.path();
    for part in ["1/3", "2/3", "3/3"] {
        bramah(folder, &["sweep", "press.toml", "--part", part]);
    }
    let first = read(folder, "press.1-of-3.csv");
    let two = ["sweep", "--merge", "-o", "two.csv", "press.1-of-3.csv", "press.2-of-3.csv"];
    let out = run(folder, env!("CARGO_BIN_EXE_bramah"), &two);
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(said.contains("10 runs in two.csv, 4 missing"), "{said}");
    assert_eq!(out.status.code(), Some(1), "scripts see that runs are missing");
    let parts = ["press.3-of-3.csv", "press.1-of-3.csv", "press.2-of-3.csv"];
    bramah(folder, &[&["sweep", "--merge", "-o", "all.csv"], &parts[..]].concat());
    assert_eq!(read(folder, "all.csv"), whole(folder));
    // a share that was killed goes on: what is there is not run again
    let kept: String = first.lines().take(4).map(|l| format!("{l}\n")).collect();
    std::fs::write(folder.join("press.1-of-3.csv"), kept).expect("written");
    let said = bramah(folder, &["sweep", "press.toml", "--part", "1/3"]);
    assert!(said.contains("runs are in press.1-of-3.csv already"), "{said}");
    assert_eq!(read(folder, "press.1-of-3.csv"), first);
}

/// The recipe, word by word, with another number of shares.
#[test]
fn the_recipe_for_gnu_parallel() {
    let gnu = Command::new("parallel").arg("--version").output();
    if !gnu.is_ok_and(|out| String::from_utf8_lossy(&out.stdout).contains("GNU parallel")) {
        eprintln!("skipped: GNU parallel is not installed");
        return;
    }
    let folder = folder();
    let folder = folder.path();
    let recipe = "parallel -j 2 --retries 3 bramah sweep press.toml --jobs 1 --part {}/4 ::: $(seq 4)
                  bramah sweep --merge -o press.csv press.*-of-4.csv";
    let programs = Path::new(env!("CARGO_BIN_EXE_bramah")).parent().expect("a folder");
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    let mut shell = Command::new("sh");
    let out = shell.args(["-e", "-c", recipe]).env("PATH", path).current_dir(folder).output().expect("starts");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    assert_eq!(read(folder, "press.csv"), whole(folder));
}

#[test]
fn a_scatter_matrix() {
    let folder = folder();
    let folder = folder.path();
    bramah(folder, &["sweep", "press.toml", "--plot", "press.svg"]);
    assert_eq!(read(folder, "press.svg").matches("<circle").count(), 3 * 14);
    bramah(folder, &["sweep", "press.toml", "--plot", "press.html"]);
    let page = read(folder, "press.html");
    assert!(page.matches("<circle").count() == 3 * 14 && page.contains("<script"));
}
