use super::*;
use bramah_syntax::diag::render::short_list;
use bramah_syntax::world::MemoryWorld;

const MODEL: &str = "
model Tank
  input Real u(unit = \"m3/s\");
  input Real T(unit = \"K\") = 300;
  parameter Real A(unit = \"m2\") = 1;
  parameter Real k(unit = \"m3/(s.Pa)\") = 1e-6;
  parameter Integer n = 2;
  Real p(unit = \"Pa\", start = 0, fixed = true);
equation
  A*der(p) = 1e4*u - k*p;
end Tank;";

const STUDY: &str = r#"version = 1
model = "Tank.mo"
class = "Tank"
[inputs]
u = { column = "q", unit = "l/min" }
[signals]
p1 = { variable = "p", column = "level", unit = "bar", sign = -1, full_scale = "2 bar", accuracy = "0.5 %" }
[[recordings]]
file = "a.csv"
time = "t_s"
window = [0.0, 2.5]
[[recordings]]
file = "b.csv"
role = "held"
[[recordings]]
file = "c.csv"
optional = true
[parameters]
A = { sigma = "3 %", min = "10 dm2" }
"k" = "exact"
[effects]
exclude = ["backlash"]
"#;

const RECORDING: &str = "t_s,q,level,T\n0,60,0,1\n1,60,-1,1\n2,120,,1\n3,120,-3,1\n";

fn world(study: &str) -> MemoryWorld {
    let mut world = MemoryWorld::default();
    world.add("lab/Tank.mo", MODEL);
    world.add("lab/study.toml", study);
    world.add("lab/a.csv", RECORDING);
    world
}

/// Reads, binds and loads the training recordings; hands out what was made and what was said.
fn load(world: &MemoryWorld) -> (Option<(BoundStudy, Vec<Recording>)>, String) {
    let mut sources = Sources::default();
    let mut said = Vec::new();
    let made = (|| {
        let study = Study::read(world, Path::new("lab/study.toml"), &mut sources).sink(&mut said)?;
        let flat = bramah_model::compile::flatten(world, &study.request()).value.expect("the model is right").flat;
        let bound = study.bind(&flat).sink(&mut said)?;
        let recordings = bound.load(world, None, RecordingRole::Train, &mut sources).sink(&mut said)?;
        Some((bound, recordings))
    })();
    (made, short_list(&sources, &said))
}

#[test]
fn a_study_becomes_recordings_in_the_units_of_the_model() {
    let (made, said) = load(&world(STUDY));
    assert_eq!(said, "");
    let (bound, recordings) = made.unwrap();
    assert_eq!(recordings.len(), 1);
    let r = &recordings[0];
    assert_eq!(
        (r.times.as_slice(), r.inputs[0].as_slice()),
        ([0.0, 1.0, 2.0].as_slice(), [1e-3, 1e-3, 2e-3].as_slice())
    );
    assert_eq!(r.signals[0][..2], [0.0, 1e5]);
    assert!(r.signals[0][2].is_nan());
    assert_eq!(full_scales(&bound, &recordings), [2e5]);
    assert_eq!(bound.signals[0].deviation(2e5), Some(1e3));
    let a = &bound.parameters[0];
    assert_eq!((a.knowledge, a.min, a.max), (DataSheetTolerance::Relative(0.03), Some(0.1), None));
    assert_eq!(bound.parameters[1].knowledge, DataSheetTolerance::Exact);
}

/// A sensor that stands still has its size for a range, so that errors have a measure.
#[test]
fn the_range_of_a_signal_that_stands_still() {
    let study = STUDY.replace(", full_scale = \"2 bar\"", "");
    for (cells, range) in [("1,1,1", 1e5), ("0,0,0", 1.0), ("0,1,1", 1e5)] {
        let mut world = world(&study);
        let rows: String = cells.split(',').zip(0..).map(|(cell, t)| format!("{t},60,{cell},1\n")).collect();
        world.add("lab/a.csv", format!("t_s,q,level,T\n{rows}"));
        let (bound, recordings) = load(&world).0.expect("readable");
        assert_eq!(full_scales(&bound, &recordings), [range], "{cells}");
    }
}

#[test]
fn held_recordings_are_read_only_when_asked_for() {
    let mut world = world(STUDY);
    let bound = load(&world).0.unwrap().0;
    let held =
        |world: &MemoryWorld| bound.load(world, Some(Path::new("lab")), RecordingRole::Held, &mut Sources::default());
    assert!(bound.has(RecordingRole::Held) && held(&world).value.is_none());
    world.add("lab/b.csv", "t,q,level\n0,1,2\n1,1,3\n");
    assert_eq!(held(&world).value.unwrap()[0].signals[0], [-2e5, -3e5]);
}

#[test]
fn mistakes_are_shown_at_their_place() {
    let changes = [
        ("version = 1", "version = 2"),
        ("version = 1", ""),
        ("model = \"Tank.mo\"", "modl = \"Tank.mo\""),
        ("column = \"q\", unit = \"l/min\"", "colum = \"q\""),
        ("unit = \"bar\", sign", "unit = \"barr\", sign"),
        ("sign = -1", "sign = 2"),
        ("\"2 bar\"", "\"2 N\""),
        ("\"0.5 %\"", "\"-1 %\""),
        ("variable = \"p\"", "variable = \"pp\""),
        ("variable = \"p\"", "variable = \"A\""),
        ("unit = \"bar\", sign", "unit = \"N\", sign"),
        ("u = { column = \"q\", unit = \"l/min\" }", ""),
        ("u = {", "v = {"),
        ("column = \"q\"", "column = \"Q\""),
        ("\"a.csv\"", "\"z.csv\""),
        ("time = \"t_s\"", "time = \"tt\""),
        ("window = [0.0, 2.5]", "window = [2.5, 0.0]"),
        ("window = [0.0, 2.5]", "window = [20.0, 25.0]"),
        ("role = \"held\"", "role = \"test\""),
        ("optional = true", "optional = 1"),
        ("A = { sigma = \"3 %\", min = \"10 dm2\" }", "B = { sigma = \"3 %\" }"),
        ("A = { sigma = \"3 %\", min = \"10 dm2\" }", "A = 3"),
        ("A = { sigma = \"3 %\", min = \"10 dm2\" }", "n = { min = 1 }"),
        ("min = \"10 dm2\"", "min = 2, max = 1"),
        ("min = \"10 dm2\"", "min = \"1 s\""),
        ("exclude = [\"backlash\"]", "exclud = []"),
        ("exclude = [\"backlash\"]", "exclude = \"x"),
    ];
    let said = changes.map(|(from, to)| {
        assert!(STUDY.contains(from), "{from}");
        format!("{to}\n{}\n", load(&world(&STUDY.replacen(from, to, 1))).1)
    });
    insta::assert_snapshot!(said.join(""));
}

#[test]
fn bad_columns() {
    let texts = [
        "t_s,q,level\n0,1,2\n1,2,2\n",
        "t_s,q,level\n0,1,\n1,2,\n",
        "t_s,q,level\n0,1,1\n0,1,2\n",
        "t_s,q,level\n0,,1\n1,1,2\n",
        "t_s,q,level\n0,1,1\n1,1,x\n",
    ];
    let said = texts.map(|text| {
        let mut world = world(STUDY);
        world.add("lab/a.csv", text);
        load(&world).1
    });
    insta::assert_snapshot!(said.join(""));
}

proptest::proptest! {
    #[test]
    fn never_panics(text in "(?s)(version|inputs|\\[|\\]|recordings|file|=|\\{|\\}|\"|\\.|1|a|\n|,){0,30}") {
        load(&world(&text));
    }
}

#[test]
fn an_input_that_steps_is_not_joined_by_straight_lines() {
    let stepping = "t_s,q,level,T\n0,1,0,1\n0.1,1,0,1\n0.2,2,0,1\n0.3,2,0,1\n0.4,1,0,1\n0.5,1,0,1\n0.6,2,0,1\n0.7,2,0,1\n\
                    0.8,1,0,1\n0.9,1,-1,1\n";
    let study = STUDY.replace("unit = \"l/min\"", "unit = \"l/min\", hold = false");
    let said = |recording: &str| {
        let mut world = world(&study);
        world.add("lab/a.csv", recording);
        load(&world).1
    };
    assert!(said(stepping).contains("W608") && said(stepping).contains("`u` jumps 4 times"), "{}", said(stepping));
    // a trajectory that climbs from sample to sample
    assert_eq!(said(&stepping.replace("0.1,1", "0.1,1.5").replace("0.5,1", "0.5,1.5")), "");
}

#[test]
fn a_value_whose_square_is_no_number_is_refused() {
    let mut world = world(STUDY);
    world.add("lab/a.csv", "t_s,q,level\n0,1,2\n1,2,1e200\n2,3,3\n");
    let (value, said) = load(&world);
    // as it is written, not in the units of the model
    assert!(value.is_none() && said.contains("E601") && said.contains("the column `level` holds 1e200"), "{said}");
}

#[test]
fn an_input_that_stands_still_in_all_recordings_is_told() {
    let said = |first: &str, second: &str| {
        let mut world = world(&STUDY.replace("\"held\"", "\"train\"\ntime = \"t_s\""));
        world.add("lab/a.csv", first);
        world.add("lab/b.csv", second);
        load(&world).1
    };
    let (still, moving) = ("t_s,q,level\n0,1,2\n1,1,3\n2,1,3\n3,1,2\n", "t_s,q,level\n0,1,2\n1,2,3\n2,3,3\n3,1,2\n");
    let reported = said(still, still);
    assert!(reported.contains("W605") && reported.contains("`q` never changes"), "{reported}");
    assert!(!said(still, moving).contains("W605"), "{}", said(still, moving));
}

#[test]
fn units_of_file_and_study_must_agree() {
    let said = |recording: &str| {
        let mut world = world(STUDY);
        world.add("lab/a.csv", recording);
        load(&world).1
    };
    let rows = "0;60;0\n1;60;-1\n2;120;-3\n";
    assert_eq!(said(&format!("t_s;q;level\ns;lpm;bar\n{rows}")), "");
    let row = said(&format!("t_s;q;level\ns;l/min;psi\n{rows}"));
    assert!(row.contains("a.csv:2:9: error[E612]") && row.contains("`level` is `psi` in its file, but `bar`"), "{row}");
    let name = said(&format!("t_s;q [ml/s];level\n{rows}"));
    assert!(name.contains("a.csv:1:5: error[E612]") && name.contains("`q` is `ml/s`"), "{name}");
}

/// A time column that counts milliseconds and does not say so is read in seconds, with a word about it.
#[test]
fn times_that_look_like_milliseconds_are_told() {
    let study = STUDY.replace("time = \"t_s\"", "time = \"Zeit\"").replace("window = [0.0, 2.5]", "");
    let said = |head: &str, step: f64| {
        let mut world = world(&study);
        let rows: String = (0..500).map(|i| format!("{};{};{}\n", step * f64::from(i), i % 7, i % 5)).collect();
        world.add("lab/a.csv", format!("{head}\n{rows}"));
        load(&world).1
    };
    for step in [4.0, 2.5] {
        let told = said("Zeit;q;level", step);
        assert!(told.contains("a.csv:1:1: warning[W611]") && told.contains(&format!("every {step} s")), "{told}");
    }
    for (head, step) in
        [("Zeit [s];q;level", 4.0), ("Zeit [ms];q;level", 4.0), ("Zeit;q;level", 0.004), ("Zeit;q;level", 60.0)]
    {
        assert_eq!(said(head, step), "", "{head} {step}");
    }
}
