//! Random models: the analysis ends with a valid result or with errors, never with a panic, and does not depend on the
//! order of equations.

use super::super::{StateChoice, analyze};
use super::model::Model;
use super::validity;
use proptest::prelude::*;

/// Some expressions over `x0..x5`, `b0..b2` and `n`.
fn term() -> impl Strategy<Value = String> {
    let x = (0..6_u32).prop_map(|i| format!("x{i}"));
    let leaf = prop_oneof![
        4 => x.clone(),
        2 => x.clone().prop_map(|x| format!("der({x})")),
        1 => Just("time".to_owned()),
        1 => Just("p".to_owned()),
        1 => Just("2".to_owned()),
        1 => Just("n".to_owned()),
    ];
    leaf.prop_recursive(3, 12, 3, move |inner| {
        prop_oneof![
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a} + {b})")),
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a} - {b})")),
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a}*{b})")),
            inner.clone().prop_map(|a| format!("sin({a})")),
            inner.clone().prop_map(|a| format!("floor({a})")),
            ((0..3_u32), inner.clone(), inner.clone()).prop_map(|(b, x, y)| format!("(if b{b} then {x} else {y})")),
            (inner.clone(), inner.clone(), inner).prop_map(|(a, x, y)| format!("(if {a} > {x} then {x} else {y})")),
        ]
    })
}

fn condition() -> impl Strategy<Value = String> {
    let simple = prop_oneof![
        (term(), term()).prop_map(|(a, b)| format!("({a} < {b})")),
        (0..3_u32).prop_map(|i| format!("b{i}")),
        (0..3_u32).prop_map(|i| format!("pre(b{i})")),
        Just("initial()".to_owned()),
        Just("sample(0.1, 0.5)".to_owned()),
    ];
    (simple.clone(), simple, any::<bool>())
        .prop_map(|(a, b, and)| if and { format!("{a} and {b}") } else { format!("{a} or not {b}") })
}

#[derive(Clone, Debug)]
struct Sketch {
    continuous: Vec<(String, String)>,
    conditions: Vec<String>,
    fires: String,
    fixed: Vec<bool>,
    turn: usize,
}

fn sketch() -> impl Strategy<Value = Sketch> {
    let equation = prop_oneof![
        (term(), term()),
        ((0..6_u32), term()).prop_map(|(i, e)| (format!("x{i}"), e)),
        ((0..6_u32), term()).prop_map(|(i, e)| (format!("der(x{i})"), e)),
        ((0..6_u32), (0..6_u32)).prop_map(|(i, j)| (format!("x{i}"), format!("-x{j}"))),
    ];
    (
        prop::collection::vec(equation, 6),
        prop::collection::vec(condition(), 3),
        condition(),
        prop::collection::vec(any::<bool>(), 6),
        0..6_usize,
    )
        .prop_map(|(continuous, conditions, fires, fixed, turn)| Sketch {
            continuous,
            conditions,
            fires,
            fixed,
            turn,
        })
}

fn build(sketch: &Sketch, turn: usize) -> Model {
    let mut m = Model::new();
    m.parameters("p = 3").reals("x0 x1 x2 x3 x4 x5").booleans("b0 b1 b2").integers("n");
    for (i, _) in sketch.fixed.iter().enumerate().filter(|(_, fixed)| **fixed) {
        m.fixed(&format!("x{i} = 1"));
    }
    for k in 0..sketch.continuous.len() {
        let (lhs, rhs) = &sketch.continuous[(k + turn) % sketch.continuous.len()];
        m.equations(&format!("{lhs} = {rhs}"));
    }
    for (i, condition) in sketch.conditions.iter().enumerate() {
        m.equations(&format!("b{i} = {condition}"));
    }
    m.when(&[(&sketch.fires, "n = pre(n) + 1")]);
    m
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]
    #[test]
    fn any_model_gives_a_valid_system_or_an_error(sketch in sketch()) {
        let straight = analyze(&build(&sketch, 0).flat, &StateChoice::default());
        if let Some(dae) = &straight.value {
            validity::check(dae);
        } else {
            prop_assert!(straight.diagnostics.iter().any(bramah_syntax::diag::Diagnostic::is_error));
        }
        let again = analyze(&build(&sketch, 0).flat, &StateChoice::default());
        prop_assert_eq!(
            straight.value.as_ref().map(super::super::Dae::dae_text),
            again.value.as_ref().map(super::super::Dae::dae_text)
        );
        let turned = analyze(&build(&sketch, sketch.turn).flat, &StateChoice::default());
        if let Some(dae) = &turned.value {
            validity::check(dae);
        }
    }
}
