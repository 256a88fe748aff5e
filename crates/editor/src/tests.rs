//! Answers about small texts; `|` marks the place asked about.

use super::hints::{ParameterHints, hints};
use super::navigate::{self, FileRange};
use super::{DocumentView, EditorWorkspace, actions, complete, hover, messages, outline, signature, tokens};
use bramah_syntax::world::MemoryWorld;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const FILE: &str = "/rig/Press.mo";

const PRESS: &str = "model Press \"A press\"
  inner Oil.ISOVG46 oil;
  parameter Modelica.Units.SI.Volume V = 2*V_half \"Volume of the line\";
  parameter Modelica.Units.SI.Volume V_half(displayUnit = \"ml\") = 5e-5;
  Hydraulic.PressureSource supply(p = 1e7);
  Hydraulic.Orifice throttle(A = 1e-6);
  Hydraulic.Volume line(V = V);
  Hydraulic.Cylinder cylinder(A_1 = 2e-3);
  Hydraulic.Tank tank;
  Real x[3];
equation
  connect(supply.port, throttle.port_a);
  connect(throttle.port_b, line.port);
  connect(line.port, cylinder.port_1);
  connect(cylinder.port_2, tank.port);
  for i in 1:3 loop
    x[i] = i*line.p;
  end for;
end Press;
";

/// Takes the mark out of a text.
fn marked(text: &str) -> (String, u32) {
    let at = text.find('|').expect("a mark");
    (text.replacen('|', "", 1), at as u32)
}

fn look<T>(world: &MemoryWorld, path: &str, act: impl FnOnce(&mut DocumentView<'_, '_>) -> T) -> T {
    EditorWorkspace { world, libraries: &[] }.look(Path::new(path), |mut view| act(&mut view)).expect("it is there")
}

/// What is said of the models of a file, and what is learnt of their parameters.
fn checked(world: &MemoryWorld) -> (Vec<messages::FileDiagnostic>, ParameterHints) {
    let mut facts = ParameterHints::default();
    let texts = EditorWorkspace { world, libraries: &[] };
    let said = messages::of_models(&texts, Path::new(FILE), &|_| None, &mut facts, &|| true);
    (said, facts)
}

/// Looks at `PRESS` with a mark before the first or a later occurrence of a word.
fn in_press<T>(before: &str, act: impl FnOnce(&mut DocumentView<'_, '_>, u32) -> T) -> T {
    let at = PRESS.find(before).expect("the words") as u32;
    look(&MemoryWorld::single(FILE, PRESS), FILE, |view| act(view, at))
}

fn completions(text: &str) -> Vec<String> {
    let (text, at) = marked(text);
    let all = look(&MemoryWorld::single(FILE, text), FILE, |view| complete::complete(view, at));
    all.into_iter().map(|i| i.label).collect()
}

fn has(text: &str, wanted: &[&str]) {
    let found = completions(text);
    for word in wanted {
        assert!(found.iter().any(|f| f == word), "`{word}` is missing for {text}\n{found:?}");
    }
}

fn lacks(text: &str, unwanted: &[&str]) {
    let found = completions(text);
    for word in unwanted {
        assert!(!found.iter().any(|f| f == word), "`{word}` is offered for {text}");
    }
}

#[test]
fn definitions_are_found_through_packages_modifiers_and_connections() {
    let at = |before: &str| in_press(before, navigate::definition).expect(before);
    assert_eq!(at("Volume line").path, PathBuf::from("components/Hydraulic/Volume.mo"));
    assert_eq!(at("V_half \"Vol").range, (3, 37, 3, 43));
    assert_eq!(at("A = 1e-6").path, PathBuf::from("components/Hydraulic/Orifice.mo"));
    assert_eq!(at("A_1 = ").path, PathBuf::from("components/Hydraulic/Cylinder.mo"));
    assert_eq!(at("throttle.port_a").range, (5, 20, 5, 28));
    assert_eq!(at("port_1").path, PathBuf::from("components/Hydraulic/Cylinder.mo"));
    assert_eq!(at("i*line").range, (15, 6, 15, 7));
    // the parameter of a base class
    assert!(at("A = 1e-6").range.0 > 0);
    let typed = in_press("throttle(A", navigate::type_definition).expect("its class");
    assert_eq!(typed.path, PathBuf::from("components/Hydraulic/Orifice.mo"));
    assert_eq!(in_press("equation", navigate::definition), None);
}

#[test]
fn hover_shows_declaration_unit_value_and_text() {
    let world = MemoryWorld::single(FILE, PRESS);
    let mut facts = ParameterHints::default();
    let said = messages::of_models(
        &EditorWorkspace { world: &world, libraries: &[] },
        Path::new(FILE),
        &|_| None,
        &mut facts,
        &|| true,
    );
    assert!(said.iter().all(|m| m.path == Path::new(FILE)), "{said:#?}");
    let text = |before: &str| {
        let found = in_press(before, |view, at| hover::hover(view, at, &facts)).expect(before);
        match found.contents {
            lsp_types::HoverContents::Markup(markup) => markup.value,
            other => panic!("{other:?}"),
        }
    };
    insta::assert_snapshot!(
        [text("V = V"), text("V_half(disp"), text("line.p;"), text("Orifice throttle"),].join("\n---\n")
    );
}

#[test]
fn hints_show_values_in_their_units() {
    let world = MemoryWorld::single(FILE, PRESS);
    let (_, facts) = checked(&world);
    let all = look(&world, FILE, |view| hints(view, &facts));
    let mut shown = String::new();
    for hint in all {
        let lsp_types::InlayHintLabel::String(label) = hint.label else { panic!("a string") };
        let _ = writeln!(shown, "{} {label}", hint.position.line + 1);
    }
    insta::assert_snapshot!(shown, @"
    3 = 0.0001 m3
    4 m3 = 50 ml
    5 Pa = 100 bar
    6 m2 = 1 mm2
    7 = 100 ml
    8 m2 = 20 cm2
    ");
}

#[test]
fn references_and_renaming_reach_other_files_of_a_package() {
    let mut world = MemoryWorld::default();
    world.add("/rig/Plant/package.mo", "package Plant\n  constant Real size = 2;\nend Plant;\n");
    world
        .add("/rig/Plant/Part.mo", "within Plant;\nmodel Part\n  parameter Real k = size;\n  Real y = k;\nend Part;\n");
    world.add("/rig/Plant/Use.mo", "within Plant;\nmodel Use\n  Part a(k = 3), b;\n  Real z = a.k + b.y;\nend Use;\n");
    world.add("/rig/Other.mo", "model Other\n  Real k = 1;\nend Other;\n");
    let texts = EditorWorkspace { world: &world, libraries: &[] };
    let files: Vec<PathBuf> =
        ["Plant/package.mo", "Plant/Part.mo", "Plant/Use.mo", "Other.mo"].map(|f| PathBuf::from("/rig").join(f)).into();
    let of = |file: &str, before: &str| {
        let path = PathBuf::from("/rig").join(file);
        let at = bramah_syntax::world::World::read(&world, &path).unwrap().find(before).unwrap() as u32;
        let declared = texts.look(&path, |mut view| navigate::declared(&mut view, at)).flatten().expect("declared");
        let places = navigate::references(&texts, &files, &declared);
        (declared, places.iter().map(place).collect::<Vec<_>>().join(" "))
    };
    assert_eq!(of("Plant/Use.mo", "k = 3").1, "Part.mo:3:18 Part.mo:4:12 Use.mo:3:10 Use.mo:4:14");
    assert_eq!(of("Plant/Part.mo", "size").1, "Part.mo:3:22 package.mo:2:17");
    let (part, places) = of("Plant/Use.mo", "Part a");
    assert_eq!(
        places,
        "Part.mo:2:7 Part.mo:5:5 Use.mo:3:3 Use.mo:3:3".replace(" Use.mo:3:3 Use.mo:3:3", " Use.mo:3:3")
    );
    assert!(part.own_file);
    assert_eq!(of("Other.mo", "k = 1").1, "Other.mo:2:8");
    let (_, package) = of("Plant/package.mo", "Plant\n");
    assert_eq!(package, "Part.mo:1:8 Use.mo:1:8 package.mo:1:9 package.mo:3:5");
    let taken = |before: &str, name: &str| {
        let path = Path::new("/rig/Plant/Use.mo");
        let at = bramah_syntax::world::World::read(&world, path).unwrap().find(before).unwrap() as u32;
        texts.look(path, |mut view| navigate::class_with(&mut view, at, name)).flatten()
    };
    assert_eq!(taken("k = 3", "y").as_deref(), Some("Plant.Part"));
    assert_eq!(taken("k = 3", "z"), None);
    assert_eq!(taken("Part a", "Use").as_deref(), Some("Plant"));
    assert!(
        navigate::is_name("k_2") && !navigate::is_name("end") && !navigate::is_name("a.b") && !navigate::is_name("2")
    );
}

fn place(place: &FileRange) -> String {
    let name = place.path.file_name().unwrap_or_default().to_string_lossy();
    format!("{name}:{}:{}", place.range.0 + 1, place.range.1 + 1)
}

#[test]
fn completions_fit_the_place() {
    has("model M\n  Hydraulic.|\nend M;", &["Orifice", "Volume", "Examples"]);
    has("model M\n  Hyd|\nend M;", &["Hydraulic", "parameter"]);
    has("model M\n  Hydraulic.Orifice o(|\nend M;", &["A", "C_d"]);
    has("model M\n  Hydraulic.Orifice o(A = 1, |);\nend M;", &["C_d"]);
    lacks("model M\n  Hydraulic.Orifice o(A = |);\nend M;", &["C_d"]);
    has("model M\n  Hydraulic.Orifice o(A = k|);\n  parameter Real k = 1;\nend M;", &["k"]);
    has("model M\n  Hydraulic.Orifice o(port_a(|));\nend M;", &["p", "q"]);
    has("model M\n  Hydraulic.Orifice o(port_a.|);\nend M;", &["p", "q"]);
    has("model M\n  Real x(|);\nend M;", &["start", "unit"]);
    has("model M\n  Real x(unit = \"|\");\nend M;", &["bar", "rev/min"]);
    has("model M\n  Hydraulic.Orifice o;\n  Hydraulic.Tank t;\nequation\n  connect(o.|, t.port);\nend M;", &["port_a"]);
    lacks("model M\n  Hydraulic.Orifice o;\n  Hydraulic.Tank t;\nequation\n  connect(o.|, t.port);\nend M;", &["A"]);
    has("model M\n  Hydraulic.Orifice o;\nequation\n  connect(|\nend M;", &["o"]);
    has("model M\n  Hydraulic.Orifice o[2];\n  Real y;\nequation\n  y = o[1].|;\nend M;", &["q", "A"]);
    has("model M\n  extends Hydraulic.Orifice(|);\nend M;", &["A"]);
    has("model M\n  Real y = Smooth.pos(|);\nend M;", &["x", "w"]);
    has("model M\n  Real y;\nequation\n  y = |\nend M;", &["y", "sin", "time"]);
    has("model M\nequation\n  |\nend M;", &["connect", "when"]);
    has("model M\n  Modelica.Units.SI.|\nend M;", &["Pressure", "Volume"]);
    has("model M\n  replaceable model X = Hydraulic.Orifice(|);\nend M;", &["A"]);
    assert_eq!(completions("model M\n  // Hydraulic.|\nend M;"), [""; 0]);
    assert_eq!(completions("model M \"about Hyd|\"\nend M;"), [""; 0]);
    has("|", &[]);
}

#[test]
fn signatures_name_inputs_and_parameters() {
    let of = |text: &str| {
        let (text, at) = marked(text);
        let help = look(&MemoryWorld::single(FILE, text), FILE, |view| signature::help(view, at)).expect("a signature");
        (help.signatures[0].label.clone(), help.active_parameter)
    };
    let (label, active) = of("model M\n  Real y = Smooth.pos(1, |);\nend M;");
    assert_eq!((label.as_str(), active), ("Smooth.pos(Real x, Real w)", Some(1)));
    let (label, active) = of("model M\n  Hydraulic.Orifice o(C_d = |);\nend M;");
    assert!(label.starts_with("Hydraulic.Orifice("), "{label}");
    assert!(active.is_some());
    let (_, active) = of("model M\n  Real y = Smooth.pos(w = |);\nend M;");
    assert_eq!(active, Some(1));
}

#[test]
fn messages_come_with_corrections() {
    let text = "model M\n  Hydraulic.Orifise o(A = 1e-6);\n  Real y\n  = 1;\nend M;\n";
    let (found, _) = checked(&MemoryWorld::single(FILE, text));
    let first = &found[0];
    assert_eq!(first.diagnostic.range.start, lsp_types::Position::new(1, 12));
    let correction = first.correction.clone().expect("the name that was meant");
    assert_eq!(
        (correction.title.as_str(), correction.edit.new_text.as_str()),
        ("Replace `Orifise` by `Orifice`", "Orifice")
    );
    let slips = messages::of_syntax(Path::new(FILE), "model M\n  Real x = 1\n  Real y = 2;\nend N;\n");
    let fixes: Vec<actions::QuickFix> = slips.into_iter().filter_map(|m| m.correction).collect();
    assert_eq!(fixes.iter().map(|f| f.title.as_str()).collect::<Vec<_>>(), ["Insert `;`", "Replace `N` by `M`"]);
}

#[test]
fn a_component_with_open_ports_is_no_fault_of_its_own() {
    let text = "model Leak\n  Interfaces.HydraulicPort port;\n  parameter Real G(unit = \"m3/(s.Pa)\") = 1e-12;\nequation\n  port.q = G*port.p;\nend Leak;\n";
    let (found, _) = checked(&MemoryWorld::single(FILE, text));
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn outlines_folds_and_colours() {
    let world = MemoryWorld::single(FILE, PRESS);
    let symbols = look(&world, FILE, |view| outline::symbols(view));
    assert_eq!(symbols.len(), 1);
    assert_eq!(symbols[0].children.as_ref().map(Vec::len), Some(9));
    let folds: Vec<(u32, u32)> = outline::folds(PRESS).iter().map(|f| (f.start_line, f.end_line)).collect();
    assert_eq!(folds, [(15, 17), (0, 18)]);
    let colours = look(&world, FILE, tokens::tokens);
    let mut line = 0;
    let mut last = (0, 0);
    for token in &colours {
        line += token.delta_line;
        let start = if token.delta_line == 0 { last.1 + token.delta_start } else { token.delta_start };
        assert!((line, start) >= last, "in order");
        last = (line, start);
    }
    assert!(colours.len() > 40, "{}", colours.len());
}

#[test]
fn files_that_ship_can_be_looked_at() {
    let world = MemoryWorld::default();
    let path = "components/Hydraulic/Orifice.mo";
    let name = look(&world, path, |view| view.library.full_name(view.classes[0]));
    assert_eq!(name, "Hydraulic.Orifice");
    let name = look(&world, "components/Hydraulic/package.mo", |view| view.library.full_name(view.classes[0]));
    assert_eq!(name, "Hydraulic");
}

proptest::proptest! {
    /// Whatever stands in a text, and wherever one asks.
    #[test]
    fn no_question_fails(cut in 0..PRESS.len(), end in 0..PRESS.len(), word in "[a-z(.=\"\\[{;/]{0,4}", at in 0..PRESS.len()) {
        let (cut, end) = (cut.min(end), cut.max(end));
        let text = format!("{}{word}{}", &PRESS[..cut], &PRESS[end..]);
        let at = (at as u32).min(text.len() as u32);
        look(&MemoryWorld::single(FILE, &*text), FILE, |view| {
            complete::complete(view, at);
            signature::help(view, at);
            hover::hover(view, at, &ParameterHints::default());
            navigate::definition(view, at);
            tokens::tokens(view);
            outline::symbols(view);
        });
        outline::folds(&text);
    }
}
