use super::*;

/// Robertson's reaction as a DAE, with two crossings; `fault` spoils it on purpose.
struct Robertson {
    fault: Fault,
}

#[derive(PartialEq, Clone, Copy)]
enum Fault {
    None,
    PanicAt(f64),
    NanAfter(f64),
    SingularAfter(f64),
    WrongJacobian,
}

impl DaeEquations for Robertson {
    fn residual(&mut self, t: f64, y: &[f64], yp: &[f64], r: &mut [f64]) -> EvaluationStatus {
        match self.fault {
            Fault::PanicAt(at) if t > at => panic!("on purpose at {at}"),
            Fault::NanAfter(at) if t > at => return EvaluationStatus::Retry,
            _ => {}
        }
        let v = -0.04 * y[0] + 1e4 * y[1] * y[2];
        r[0] = v - yp[0];
        r[1] = -v - 3e7 * y[1] * y[1] - yp[1];
        r[2] = y[0] + y[1] + y[2] - 1.0;
        EvaluationStatus::Done
    }
    fn jacobian(&mut self, t: f64, cj: f64, y: &[f64], _: &[f64], val: &mut [f64]) -> EvaluationStatus {
        let b = 1e4 * y[1];
        val.copy_from_slice(&[-0.04 - cj, 0.04, 1.0, 1e4 * y[2], -1e4 * y[2] - 6e7 * y[1] - cj, 1.0, b, -b, 1.0]);
        match self.fault {
            Fault::SingularAfter(at) if t > at => val.fill(0.0),
            Fault::WrongJacobian => val.iter_mut().for_each(|v| *v *= -1e-6),
            _ => {}
        }
        EvaluationStatus::Done
    }
    fn crossings(&mut self, _: f64, y: &[f64], _: &[f64], g: &mut [f64]) {
        g[0] = y[0] - 1e-4;
        g[1] = y[2] - 0.01;
    }
}

fn robertson(fault: Fault) -> Ida<Robertson> {
    let pattern = SparsityPattern { n: 3, colptr: vec![0, 3, 6, 9], rowidx: [0, 1, 2].repeat(3) };
    let tolerances = IntegratorTolerances { relative: 1e-4, absolute: vec![1e-8, 1e-6, 1e-6], share: vec![1.0; 3] };
    let lu = Lu::new(&pattern, &[1.0, 1e-4, 1.0]);
    let start = (0.0, &[1.0, 0.0, 0.0][..], &[-0.04, 0.04, 0.0][..]);
    Ida::new(Robertson { fault }, &pattern, lu, 2, &tolerances, start).expect("accepted")
}

#[test]
fn robertson_as_published() {
    let mut ida = robertson(Fault::None);
    let (mut roots, mut to) = (vec![], 0.4);
    // values of idaRoberts_dns, to the tolerance
    let published = [9.8517e-1, 9.0553e-1, 7.1579e-1, 4.5044e-1, 1.8320e-1, 3.8992e-2];
    let mut y0 = vec![];
    while to < 5e9 {
        ida.pause_after(1000);
        match ida.advance(to).expect("integrates") {
            (AdvanceReturn::Root, t) => roots.push(t),
            (AdvanceReturn::Output, _) => {
                y0.push(ida.y()[0]);
                to *= 10.0;
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(roots.len(), 2);
    assert!((roots[0] - 2.6402e-1).abs() < 2e-5 && (roots[1] - 2.0788e7).abs() < 5e4, "{roots:?}");
    for (value, expected) in y0.iter().zip(published) {
        assert!((value - expected).abs() < 1e-3 * expected, "{value} {expected}");
    }
    insta::assert_debug_snapshot!(ida.work(), @r"
    IntegratorCounters {
        steps: 359,
        residuals: 506,
        jacobians: 51,
        factorizations: 51,
        error_test_failures: 10,
        convergence_failures: 4,
        crossings: 400,
    }
    ");
}

#[test]
fn stops_exactly_pauses_and_restarts() {
    let mut ida = robertson(Fault::None);
    ida.set_stop(0.1);
    assert_eq!(ida.advance(1.0), Ok((AdvanceReturn::Stop, 0.1)));
    let (y, yp) = (ida.y().to_vec(), ida.yp().to_vec());
    let steps = ida.work().steps;
    ida.restart(0.1, &y, &yp).expect("accepted");
    ida.set_first_step(1e-3);
    ida.pause_after(5);
    let (reached, t) = ida.advance(1.0).expect("integrates");
    assert_eq!(reached, AdvanceReturn::Pause);
    assert!(t > 0.1);
    assert_eq!(ida.work().steps, steps + 5);
    let mut errors = vec![];
    ida.weighted_errors(&mut errors);
    assert!(errors.iter().any(|e| *e != 0.0));
}

#[test]
fn a_panic_in_a_callback_becomes_an_error() {
    let quiet = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let failure = robertson(Fault::PanicAt(0.2)).advance(1.0);
    std::panic::set_hook(quiet);
    assert!(matches!(failure, Err((IdaFailure::Panic(text), t)) if text.contains("on purpose") && t <= 0.2));
}

#[test]
fn faults_are_told_apart() {
    let fails = |fault| {
        let mut ida = robertson(fault);
        ida.set_shortest_step(1e-12);
        ida.advance(1.0).expect_err("must fail")
    };
    let (failure, t) = fails(Fault::NanAfter(0.1));
    assert_eq!(failure, IdaFailure::NonFinite);
    assert!(t > 0.05 && t <= 0.1, "comes close to the fault: {t}");
    assert!(matches!(fails(Fault::SingularAfter(0.1)).0, IdaFailure::Singular(Some(_))));
    assert_eq!(fails(Fault::WrongJacobian).0, IdaFailure::Convergence);
}
