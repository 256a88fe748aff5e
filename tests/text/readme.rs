//! What README says is so: its circuit runs, its commands print what stands below them, its figures are those of a run.

#![allow(clippy::disallowed_methods, reason = "reads the page, runs the command")]

use bramah::Simulation;
use bramah::results::Trajectory;
use std::path::Path;
use std::process::Command;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn readme() -> String {
    std::fs::read_to_string(Path::new(ROOT).join("README.md")).expect("the page")
}

/// The texts of the blocks of a language.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let begin = format!("```{language}\n");
    page.split(&begin).skip(1).map(|rest| rest.split("\n```").next().expect("an end")).collect()
}

/// Whether two words are the same, or numbers that differ by less than one in twenty: machines round differently.
fn alike(a: &str, b: &str) -> bool {
    let number = |word: &str| word.trim_matches(|c: char| "()%,;`:".contains(c)).parse::<f64>().ok();
    a == b
        || matches!((number(a), number(b)), (Some(a), Some(b)) if (a - b).abs() <= 0.05 * a.abs().max(b.abs()) + 0.11)
}

/// The texts between single backquotes, outside of blocks.
fn spans(page: &str) -> Vec<&str> {
    let outside = page.split("```").step_by(2);
    outside.flat_map(|text| text.lines()).flat_map(|line| line.split('`').skip(1).step_by(2)).collect()
}

/// What the command prints in a folder, stdout first.
fn bramah(folder: &Path, arguments: &[&str]) -> String {
    let run = Command::new(env!("CARGO_BIN_EXE_bramah")).current_dir(folder).args(arguments).output().expect("a run");
    let printed = String::from_utf8_lossy(&[run.stdout, run.stderr].concat()).into_owned();
    assert!(run.status.success(), "bramah {}: {printed}", arguments.join(" "));
    printed
}

#[test]
fn commands_print_what_stands_below_them() {
    let page = readme();
    let out = tempfile::tempdir().expect("a folder");
    let shown = blocks(&page, "console");
    assert!(!shown.is_empty());
    for block in shown {
        let (command, expected) = block.split_once('\n').expect("an output");
        let command = command.strip_prefix("$ bramah ").expect("a command of bramah");
        let command = command.replace("out/", &format!("{}/", out.path().display()));
        let mut words: Vec<&str> = command.split(' ').collect();
        // other tests run at the same time: by the user's clock the search would end earlier than in the page
        words.extend(["--budget", "120s"].into_iter().filter(|_| command.starts_with("gap ")));
        let printed = bramah(Path::new(ROOT), &words);
        // how many nats an effect has depends on how near to its optimum the model without it comes in the time that there is
        let words = |text: &str| {
            let lines = text.lines().map(|line| line.split(" Evidence ").next().unwrap_or(line));
            lines.flat_map(str::split_whitespace).map(str::to_owned).collect::<Vec<_>>()
        };
        let (said, wanted) = (words(&printed), words(expected));
        let same = said.len() == wanted.len() && said.iter().zip(&wanted).all(|(a, b)| alike(a, b));
        assert!(same, "README's `{command}` prints\n{printed}");
    }
    assert!(out.path().join("diagnosis.html").exists());
    leaks_are_those_of(&page, &out.path().join("diagnosis.json"));
}

/// The leak of the plant and the one of a verdict at 100 bar, in l/min.
fn leaks_are_those_of(page: &str, verdict: &Path) {
    let read = |path: &Path| std::fs::read_to_string(path).expect("a text");
    let verdict: serde_json::Value = serde_json::from_str(&read(verdict)).expect("JSON");
    let of = |name: &str| verdict["effects"][0]["parameters"][name]["value"].as_f64().expect("a number");
    let truth = read(&Path::new(ROOT).join("examples/diagnosis/truth.toml"));
    let truth = truth.lines().find_map(|l| l.strip_prefix("flow_at_100_bar_l_per_min = ")).expect("the truth");
    // as Effects.ExternalLeakTurbulent and Smooth.root say
    let (p, p_s) = (1e7_f64, of("p_s"));
    let found = 6e4 * of("K") * p / (p * p + p_s * p_s).powf(0.25);
    let line = page.lines().find(|l| l.starts_with("The plant leaks ")).expect("the sentence");
    let shown: Vec<f64> = line.split([' ', ',']).filter_map(|word| word.trim_end_matches('.').parse().ok()).collect();
    assert_eq!((shown[0], shown[1]), ((truth.parse::<f64>().expect("a number") * 100.0).round() / 100.0, 100.0));
    // half of the last digit, and what machines differ by
    assert!((shown[2] - found).abs() < 0.0075, "README says {}, the verdict {found}", shown[2]);
}

/// Subcommands that the page names have the flags that it gives them.
#[test]
fn commands_and_flags_exist() {
    let page = readme();
    let named: Vec<&str> = spans(&page).into_iter().filter_map(|span| span.strip_prefix("bramah ")).collect();
    assert!(named.len() > 15, "{named:?}");
    for command in named {
        let mut words = command.split(' ');
        let help = bramah(Path::new(ROOT), &[words.next().expect("a subcommand"), "--help"]);
        for flag in words.filter(|word| word.starts_with('-')) {
            assert!(help.contains(&format!(" {flag}")), "bramah {command}: no {flag} in\n{help}");
        }
    }
}

/// The first table of commands, for the circuit shown and for the one that `bramah new` writes.
#[test]
fn the_first_commands_work_on_both_circuits() {
    let page = readme();
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path();
    std::fs::write(folder.join("Shown.mo"), blocks(&page, "modelica")[0]).expect("a file");
    bramah(folder, &["new", "press"]);
    let rows: Vec<&str> = page
        .lines()
        .skip_while(|l| !l.starts_with("| `bramah check FILE`"))
        .take_while(|l| l.starts_with("| `bramah "))
        .collect();
    assert_eq!(rows.len(), 5);
    for file in ["Shown.mo", "press/Press.mo"] {
        for row in &rows {
            let named = spans(row);
            let command = named[0].replace("bramah ", "").replace("FILE", file);
            if command.starts_with("compare ") {
                for name in ["a.csv", "b.csv"] {
                    std::fs::copy(folder.join("out.csv"), folder.join(name)).expect("a copy");
                }
            }
            bramah(folder, &command.split(' ').collect::<Vec<_>>());
            for value in named.iter().filter_map(|span| span.strip_prefix("--set ")) {
                bramah(folder, &["simulate", file, "--set", &value.replace('"', ""), "-o", "set.csv"]);
            }
        }
    }
}

#[test]
fn links_and_folders_exist() {
    let page = readme();
    let links = page.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    let is_folder = |span: &&str| span.ends_with('/') && !span.starts_with("out/");
    let named: Vec<&str> =
        links.filter(|l| !l.contains("://")).chain(spans(&page).into_iter().filter(is_folder)).collect();
    assert!(named.len() > 12, "{named:?}");
    let missing: Vec<_> = named.iter().filter(|name| !Path::new(ROOT).join(name).exists()).collect();
    assert!(missing.is_empty(), "README names {missing:?}");
}

#[test]
fn versions_are_those_of_the_manifest() {
    let page = readme();
    let (version, rust) = (env!("CARGO_PKG_VERSION"), env!("CARGO_PKG_RUST_VERSION"));
    for text in [
        format!("bramah-{version}-x86_64-linux.tar.gz"),
        format!("bramah_{version}_amd64.deb"),
        format!("Rust {rust} or newer"),
    ] {
        assert!(page.contains(&text), "README does not say `{text}`");
    }
}

/// The lines up to the assertions are those of the page.
#[test]
fn the_program_runs() -> Result<(), bramah::Error> {
    let mut circuit = bramah::Circuit::new("Emptying");
    circuit.inner("oil", "Oil.ISOVG32"); // all components take it
    circuit.add("volume", "Hydraulic.Volume").set("V", "1 l").set("p_start", "100 bar");
    circuit.add("orifice", "Hydraulic.Orifice").add("tank", "Hydraulic.Tank");
    circuit.connect("volume.port", "orifice.port_a").connect("orifice.port_b", "tank.port");
    let mut simulation = circuit.compile()?; // once
    let first = simulation.run()?; // many times, also in parallel
    let second = simulation.set("orifice.A", 2e-6)?.run()?; // with other parameters
    let end = |t: &Trajectory| t.column("volume.p").and_then(|p| p.last()).copied().expect("a pressure");
    assert!(end(&second.trajectory) < end(&first.trajectory) && end(&first.trajectory) < 1e7);
    let (page, own) = (readme(), include_str!("readme.rs"));
    let shown = blocks(&page, "rust,ignore");
    let other: Vec<&str> = shown.iter().flat_map(|block| block.lines()).filter(|line| !own.contains(line)).collect();
    assert!(!shown.is_empty() && other.is_empty(), "README shows {other:?}");
    Ok(())
}

#[test]
fn the_first_circuit_runs() {
    let page = readme();
    let texts = blocks(&page, "modelica");
    assert!(!texts.is_empty());
    for text in texts {
        let simulation = Simulation::from_text(text).unwrap_or_else(|e| panic!("{e}"));
        simulation.run().unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Slope and intercept of p_A - p_B over the speed, bar and rev/min, from 50 to 210 bar.
fn dead_zone() -> (f64, f64) {
    let t: Trajectory =
        Simulation::shipped("ServoPump.DeadZone").and_then(|s| s.run()).unwrap_or_else(|e| panic!("{e}")).trajectory;
    let column = |name: &str| t.signals.iter().position(|s| s.name == name).map(|i| t.columns[i].clone()).expect(name);
    let (n, a, b) = (column("N"), column("p_A"), column("p_B"));
    let points = n.iter().zip(a.iter().zip(&b)).map(|(n, (a, b))| (*n, (a - b) / 1e5));
    let points: Vec<(f64, f64)> = points.filter(|(_, dp)| (50.0..=210.0).contains(dp)).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (xx, xy) =
        points.iter().fold((0.0, 0.0), |(xx, xy), p| (xx + (p.0 - x) * (p.0 - x), xy + (p.0 - x) * (p.1 - y)));
    (xy / xx, y - xy / xx * x)
}

#[test]
fn the_figures_of_the_dead_zone_are_those_of_a_run() {
    let page = readme();
    let figure = |name: &str| -> String {
        let row = page.lines().find(|l| l.starts_with(&format!("| {name}"))).expect("a row");
        row.split('|').nth(2).expect("a figure").trim().to_owned()
    };
    let (slope, intercept) = dead_zone();
    assert_eq!((figure("slope"), figure("intercept")), (format!("{slope:.2}"), format!("{intercept:.1}")));
}
