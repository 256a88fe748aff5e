//! Parquet files hold what was run, read back by the crate `parquet`, and are what pandas reads, where Python has it:
//! `PYTHON` names one with `pyarrow`.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]
#![allow(clippy::print_stdout, reason = "a test without what it needs says so")]

use parquet::basic::Type;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::path::Path;
use std::process::Command;

fn bramah(folder: &Path, arguments: &[&str]) {
    let run = Command::new(env!("CARGO_BIN_EXE_bramah")).args(arguments).current_dir(folder).output().expect("starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// What a Python script prints; `None` without a Python that has pyarrow.
fn python(folder: &Path, script: &str) -> Option<String> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", "import pyarrow.parquet"]).output();
    if !has.is_ok_and(|o| o.status.success()) {
        println!("skipped: `{python}` has no pyarrow");
        return None;
    }
    let run = Command::new(python).args(["-c", script]).current_dir(folder).output().expect("starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    Some(String::from_utf8(run.stdout).expect("text"))
}

const MODEL: &str = "model M type Mode = enumeration(low, high);
  parameter Real k(min = 0) = 1; Real x(unit = \"m\", start = 1, fixed = true); Boolean up; Integer n; Mode mode;
  equation der(x) = -k*x; up = time < 0.5; n = if up then 3 else 4; mode = if up then Mode.low else Mode.high; end M;";

/// A folder with a run of the model as Parquet and as CSV.
fn written_twice() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("M.mo"), MODEL).expect("written");
    let run = ["simulate", "M.mo", "--stop-time", "1", "--output-interval", "0.25", "--variables", "x,up,n,mode"];
    for name in ["run.parquet", "run.csv"] {
        bramah(folder.path(), &[&run[..], &["-o", name]].concat());
    }
    folder
}

#[test]
fn a_run_is_read_back_with_its_types_and_units() {
    let folder = written_twice();
    let file = std::fs::File::open(folder.path().join("run.parquet")).expect("written");
    let reader = SerializedFileReader::new(file).expect("a Parquet file");
    let head = reader.metadata().file_metadata();
    let kinds: Vec<Type> = head.schema_descr().columns().iter().map(|c| c.physical_type()).collect();
    assert_eq!(kinds, [Type::DOUBLE, Type::DOUBLE, Type::BOOLEAN, Type::INT64, Type::BYTE_ARRAY]);
    let units = head.key_value_metadata().expect("units").iter().find(|entry| entry.key == "units");
    assert_eq!(units.and_then(|u| u.value.as_deref()), Some(r#"{"time":"s","x":"m"}"#));
    let text = std::fs::read_to_string(folder.path().join("run.csv")).expect("written");
    let rows: Vec<String> = reader.get_row_iter(None).expect("rows").map(|row| cells(&row.expect("a row"))).collect();
    assert_eq!(rows, text.lines().skip(1).collect::<Vec<_>>());
}

#[test]
fn a_run_is_compared_and_drawn_from_parquet() {
    let folder = written_twice();
    bramah(folder.path(), &["compare", "run.csv", "run.parquet", "--tolerance", "1e-12"]);
    bramah(folder.path(), &["plot", "run.parquet", "-o", "run.svg"]);
    let picture = std::fs::read_to_string(folder.path().join("run.svg")).expect("drawn");
    assert!(picture.contains("x in m") && picture.contains("high"), "units and literals are read");
    std::fs::write(folder.path().join("torn.parquet"), b"PAR1 torn").expect("written");
    let torn = Command::new(env!("CARGO_BIN_EXE_bramah"))
        .args(["plot", "torn.parquet"])
        .current_dir(folder.path())
        .output()
        .expect("starts");
    assert_eq!(torn.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&torn.stderr).contains("`torn.parquet` cannot be used"));
}

/// A row as CSV writes it.
fn cells(row: &parquet::record::Row) -> String {
    let cell = |field: &Field| match field {
        Field::Double(v) => v.to_string(),
        Field::Bool(v) => v.to_string(),
        Field::Long(v) => v.to_string(),
        Field::Str(v) => v.clone(),
        other => panic!("{other}"),
    };
    row.get_column_iter().map(|(_, field)| cell(field)).collect::<Vec<_>>().join(",")
}

#[test]
fn a_run_and_a_sweep_are_read_by_pyarrow() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("M.mo"), MODEL).expect("written");
    let sweep = "file = \"M.mo\"\nstop-time = \"1 s\"\n[sweep]\nmethod = \"list\"\n[sweep.parameters]\nk = [1, 2]\n\
                 [sweep.results]\nend = \"final(x)\"\n";
    std::fs::write(folder.path().join("s.toml"), sweep).expect("written");
    let run = ["simulate", "M.mo", "--stop-time", "1", "--output-interval", "0.25", "--variables", "x,up,n,mode"];
    for name in ["run.parquet", "run.csv"] {
        bramah(folder.path(), &[&run[..], &["-o", name]].concat());
    }
    bramah(folder.path(), &["sweep", "s.toml", "-o", "s.parquet"]);
    let script = "
import csv, json, pyarrow.parquet as pq
run = pq.read_table('run.parquet')
print(run.schema.names, [str(t) for t in run.schema.types])
print(json.loads(run.schema.metadata[b'units']))
rows = list(csv.DictReader(open('run.csv')))
assert len(rows) == run.num_rows > 4
for a, b in zip(rows, run.to_pylist()):
    assert float(a['x']) == b['x'] and float(a['time']) == b['time'] and a['up'] == str(b['up']).lower()
    assert int(a['n']) == b['n'] and a['mode'] == b['mode'], (a, b)
s = pq.read_table('s.parquet').to_pydict()
print(s['run'], s['k'], [round(v, 3) for v in s['end']], s['status'])
";
    if let Some(said) = python(folder.path(), script) {
        let expected = "['time', 'x', 'up', 'n', 'mode'] ['double', 'double', 'bool', 'int64', 'string']\n\
                        {'time': 's', 'x': 'm'}\n[1, 2] [1.0, 2.0] [0.368, 0.135] ['ok', 'ok']\n";
        assert_eq!(said, expected);
    }
}
