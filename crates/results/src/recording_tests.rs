use super::*;
use bramah_syntax::diag::render::short_list;

fn read(text: &str, inputs: &[&str], outputs: &[&str]) -> (Option<Trajectory>, String) {
    let mut sources = Sources::default();
    let file = sources.add("u.csv", text);
    let own = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
    let (inputs, outputs) = (own(inputs), own(outputs));
    let checked = read_csv(&sources, file, None, ReadStrictness::Recording { inputs: &inputs, outputs: &outputs });
    let said = short_list(&sources, &checked.diagnostics);
    (checked.value, said)
}

fn result(text: &str) -> Trajectory {
    let mut sources = Sources::default();
    let file = sources.add("r.csv", text);
    let checked = read_csv(&sources, file, None, ReadStrictness::Result);
    assert_eq!(short_list(&sources, &checked.diagnostics), "");
    checked.value.unwrap()
}

#[test]
fn a_german_recording_with_units_and_remarks() {
    let (t, said) = read("# Prüfstand\nZeit;F;x\ns;N;[mm]\n0,0;1,5;\n0,1;-2e3;3\n", &["F"], &["x"]);
    assert_eq!(said, "");
    let t = t.unwrap();
    assert_eq!(t.times, [0.0, 0.1]);
    assert_eq!(t.column("F"), Some([1.5, -2000.0].as_slice()));
    assert_eq!(t.signals[1], Signal::new("x").unit("mm"));
    assert!(t.columns[1][0].is_nan());
}

#[test]
fn times_in_milliseconds_and_words_for_truth() {
    let (t, said) = read("t [ms],u\n0,true\n1.5,FALSE\n", &["u"], &[]);
    assert_eq!(said, "");
    assert_eq!(t.as_ref().unwrap().times, [0.0, 0.0015]);
    assert_eq!(t.unwrap().columns[0], [1.0, 0.0]);
}

#[test]
fn units_in_the_names() {
    let t = result("t_s,tau [N],v[3]\n0,1,2\n");
    assert_eq!(t.signals, [Signal::new("tau").unit("N"), Signal::new("v[3]")]);
}

#[test]
fn results_with_events_words_and_quoted_names() {
    let t = result("time,\"A[1,2]\",on,mode\n0,1,false,stick\n0.5,2,false,stick\n0.5,3,true,slip\n");
    assert_eq!(t.times, [0.0, 0.5, 0.5]);
    assert_eq!(t.signals[0].name, "A[1,2]");
    assert_eq!((&t.signals[1].kind, &t.columns[1]), (&Kind::Boolean, &vec![0.0, 0.0, 1.0]));
    assert_eq!(t.signals[2].kind, Kind::Enumeration(vec!["stick".into(), "slip".into()]));
    assert_eq!(t.columns[2], [1.0, 1.0, 2.0]);
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let said = |text: &str| read(text, &["u"], &["y"]).1;
    let all = [
        "time,x,y\n0,1,2\n",
        "time,u,u,y\n0,1,2,3\n",
        "time,u,y\n0,1,1\n1,1\n",
        "time,u,y\n0,1,1\n0,1,1\n",
        "time,u,y\n0,1,1\n-1,1,1\n",
        "time,u,y\n0,,\n1,,\n",
        "time,u,y\n0,nan,\n",
        "time,u,y\n0,abc,\n",
        "time,u,y\n0,1,def\n",
        "time,u,y\nx1,1,2\n1s,1,2\n",
        "0,1,2\n1,2,3\n",
        "time,u,y\n",
        "",
    ];
    insta::assert_snapshot!(all.map(said).join(""));
}

#[test]
fn gaps_in_regular_recordings() {
    let mut text = String::from("time,u\n");
    for i in (0..40).filter(|i| !(20..30).contains(i)) {
        text.push_str(&format!("{},1\n", f64::from(i) * 0.01));
    }
    insta::assert_snapshot!(read(&text, &["u"], &[]).1, @"u.csv:22:1: error[E601]: the recording has a gap");
}

#[test]
fn the_nearest_name_is_offered() {
    let mut sources = Sources::default();
    let file = sources.add("u.csv", "t_s,tau_N,q_m\n0,1,2\n");
    let inputs = ["tau_M".to_owned()];
    let checked = read_csv(&sources, file, None, ReadStrictness::Recording { inputs: &inputs, outputs: &[] });
    assert_eq!(checked.diagnostics[0].help, ["did you mean `tau_N`?"]);
}

proptest::proptest! {
    #[test]
    fn never_panics(text in "(?s)(time,u,y\n)?[\"\r\n,;\t# .1eé-]{0,60}") {
        let mut sources = Sources::default();
        let file = sources.add("r.csv", text);
        let _ = read_csv(&sources, file, None, ReadStrictness::Result);
        let inputs = ["u".to_owned()];
        let _ = read_csv(&sources, file, Some("time"), ReadStrictness::Recording { inputs: &inputs, outputs: &[] });
    }
}
