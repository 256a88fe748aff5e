use super::*;

/// A small generator of repeatable numbers in 0..1.
struct Lcg(u64);
impl Lcg {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
}

fn csc(n: usize, mut entries: Vec<(usize, usize, f64)>) -> (SparsityPattern, Vec<f64>) {
    entries.sort_by_key(|e| (e.1, e.0));
    entries.dedup_by_key(|e| (e.0, e.1));
    let mut pattern = SparsityPattern { n, colptr: vec![0; n + 1], rowidx: vec![] };
    let mut val = vec![];
    for (i, j, v) in entries {
        pattern.colptr[j + 1] += 1;
        pattern.rowidx.push(i);
        val.push(v);
    }
    for j in 0..n {
        pattern.colptr[j + 1] += pattern.colptr[j];
    }
    (pattern, val)
}

fn multiply(p: &SparsityPattern, val: &[f64], x: &[f64]) -> Vec<f64> {
    let mut b = vec![0.0; p.n];
    for j in 0..p.n {
        for k in p.colptr[j]..p.colptr[j + 1] {
            b[p.rowidx[k]] += val[k] * x[j];
        }
    }
    b
}

/// Largest error of the solution in units of `scale`.
fn error(lu: &mut Lu, p: &SparsityPattern, val: &[f64], scale: &[f64]) -> f64 {
    let x: Vec<f64> = (0..p.n).map(|i| scale[i] * (1.0 + 0.1 * i as f64)).collect();
    let mut b = multiply(p, val, &x);
    assert!(lu.solve(&mut b));
    (0..p.n).map(|i| ((b[i] - x[i]) / x[i]).abs()).fold(0.0, f64::max)
}

fn random(n: usize, per_column: usize, seed: u64) -> (SparsityPattern, Vec<f64>) {
    let mut g = Lcg(seed);
    let mut e = vec![];
    // a hidden permutation keeps the matrix regular without a full diagonal
    for j in 0..n {
        e.push(((j * 7 + 3) % n, j, 4.0 + g.next()));
        for _ in 0..per_column {
            e.push((g.below(n), j, g.next() - 0.5));
        }
    }
    csc(n, e)
}

#[test]
fn solves_small_dense_and_sparse_systems() {
    for n in [1, 2, 5, 8, 13, 24, 25, 60, 300] {
        let n = if n % 7 == 0 { n + 1 } else { n };
        let (p, val) = random(n, 3, n as u64);
        let mut lu = Lu::new(&p, &vec![1.0; n]);
        lu.factor(&val).expect("regular");
        assert!(error(&mut lu, &p, &val, &vec![1.0; n]) < 1e-10, "n = {n}");
    }
}

#[test]
fn dense_and_sparse_agree() {
    let (p, val) = random(20, 8, 5);
    let mut dense = dense::new(&p, &[1.0; 20]).expect("small enough");
    let mut sparse = SparseLu::new(&p, &[1.0; 20]);
    dense.factor(&val).expect("regular");
    sparse.factor(&val).expect("regular");
    let b: Vec<f64> = (0..20).map(f64::from).collect();
    let (mut x, mut y) = (b.clone(), b);
    assert!(dense.solve(&mut x) && sparse.solve(&mut y));
    for i in 0..20 {
        assert!((x[i] - y[i]).abs() < 1e-12 * x[i].abs().max(1.0));
    }
}

#[test]
fn survives_units_that_differ_by_1e16() {
    // rows in Pa (1e7) and m3/s (1e-9), columns likewise, shuffled
    for n in [12, 90] {
        let (p, mut val) = random(n, 3, 77);
        let row = |i: usize| if i.is_multiple_of(2) { 1e7 } else { 1e-9 };
        let column = |j: usize| if j.is_multiple_of(3) { 1e8 } else { 1e-8 };
        for j in 0..n {
            for k in p.colptr[j]..p.colptr[j + 1] {
                val[k] *= row(p.rowidx[k]) / column(j);
            }
        }
        let scale: Vec<f64> = (0..n).map(column).collect();
        let mut lu = Lu::new(&p, &scale);
        lu.factor(&val).expect("regular");
        assert!(error(&mut lu, &p, &val, &scale) < 1e-9, "n = {n}");
    }
}

#[test]
fn refactorises_without_searching_and_searches_when_pivots_go_bad() {
    let (p, mut val) = random(60, 3, 9);
    let mut lu = Lu::new(&p, &[1.0; 60]);
    lu.factor(&val).expect("regular");
    for v in &mut val {
        *v *= 1.3;
    }
    lu.factor(&val).expect("regular");
    assert_eq!((lu.factorizations, lu.pivot_searches), (2, 1));
    assert!(error(&mut lu, &p, &val, &[1.0; 60]) < 1e-10);
    // every former pivot nearly vanishes
    for j in 0..60 {
        for k in p.colptr[j]..p.colptr[j + 1] {
            if p.rowidx[k] == (j * 7 + 3) % 60 {
                val[k] = 1e-13;
            }
        }
    }
    if lu.factor(&val).is_ok() {
        assert_eq!(lu.pivot_searches, 2);
        assert!(error(&mut lu, &p, &val, &[1.0; 60]) < 1e-5);
    }
}

#[test]
fn names_the_column_without_a_pivot() {
    let (p, val) = csc(3, vec![(0, 0, 1.0), (1, 1, 2.0), (0, 2, 1.0), (1, 2, 1.0), (2, 1, 0.0)]);
    assert_eq!(Lu::new(&p, &[1.0; 3]).factor(&val), Err(SingularMatrix { column: 2 }));
    let mut sparse = SparseLu::new(&p, &[1.0; 3]);
    assert!(sparse.factor(&val).is_err());
}

#[test]
fn refuses_values_that_are_not_finite() {
    for n in [4, 40] {
        let (p, mut val) = random(n, 2, 3);
        let mut lu = Lu::new(&p, &vec![1.0; n]);
        val[3] = f64::NAN;
        assert!(lu.factor(&val).is_err(), "n = {n}");
        val[3] = 1.0;
        lu.factor(&val).expect("recovers");
    }
}

#[test]
fn structurally_awkward_arrow_and_zero_diagonal() {
    // arrow with its point first, and a zero diagonal block (Lagrange multipliers)
    let n = 80;
    let mut e = vec![];
    for i in 0..n {
        e.push((0, i, 1.0 + i as f64));
        e.push((i, 0, 2.0));
        if i > 0 && i < n / 2 {
            e.push((i, i, 5.0));
        } else if i >= n / 2 {
            e.push((i, n - 1 - (i - n / 2), 3.0));
        }
    }
    let (p, val) = csc(n, e);
    let mut lu = SparseLu::new(&p, &vec![1.0; n]);
    match lu.factor(&val) {
        Ok(_) => assert!(lu.nnz() < 6 * n, "fill {}", lu.nnz()),
        Err(s) => assert!(s.column < n),
    }
    // two-by-two zero-diagonal saddle points
    let mut e = vec![];
    for i in 0..n / 2 {
        e.push((2 * i, 2 * i, 1e-6));
        e.push((2 * i + 1, 2 * i, 1.0));
        e.push((2 * i, 2 * i + 1, 1.0));
        if i > 0 {
            e.push((2 * i, 2 * i - 2, 0.3));
        }
    }
    let (p, val) = csc(n, e);
    let mut lu = Lu::new(&p, &vec![1.0; n]);
    lu.factor(&val).expect("regular");
    assert!(error(&mut lu, &p, &val, &vec![1.0; n]) < 1e-12);
}

/// Two unknowns of which only the sum occurs, among others; the equation that is left over holds or does not.
#[test]
fn unknowns_that_nothing_determines_stay() {
    let shared = |scale: f64| {
        // x0 + x1 + x2 = 6 twice (the second one scaled), x2 + 2 x3 = 11, x3 - x2 = 1
        csc(
            4,
            vec![
                (0, 0, 1.0),
                (0, 1, 1.0),
                (0, 2, 1.0),
                (1, 0, scale),
                (1, 1, scale),
                (1, 2, scale),
                (2, 2, 1.0),
                (2, 3, 2.0),
                (3, 2, -1.0),
                (3, 3, 1.0),
            ],
        )
    };
    let (pattern, val) = shared(3.0);
    let mut lu = Lu::new(&pattern, &[1.0; 4]);
    lu.factor(&val).expect_err("nothing parts x0 and x1");
    lu.may_keep(true);
    // the second time the pivots are known
    for val in [val.clone(), shared(7.0).1, val] {
        lu.factor(&val).expect("one of them is kept");
        assert!(lu.keeps());
        let scale = val[1];
        let mut x = vec![6.0, scale * 6.0, 11.0, 1.0];
        assert!(lu.solve(&mut x));
        assert!(x[0].min(x[1]).abs() < 1e-14, "{x:?}");
        assert!((x[0] + x[1] - 3.0).abs() < 1e-12 && (x[2] - 3.0).abs() < 1e-12 && (x[3] - 4.0).abs() < 1e-12, "{x:?}");
        let mut x = vec![6.0, scale * 6.5, 11.0, 1.0];
        assert!(lu.solve(&mut x));
        assert!(x[0].abs().min(x[1].abs()) > 0.1, "a contradiction shows: {x:?}");
    }
    let (_, mut val) = shared(3.0);
    val[1] = 4.0;
    lu.factor(&val).expect("regular");
    assert!(!lu.keeps());
    assert!(error(&mut lu, &pattern, &val, &[1.0; 4]) < 1e-12);
}

/// Until the next factorisation the factors at hand serve, whatever is allowed meanwhile.
#[test]
fn factors_outlast_what_is_allowed() {
    for n in [5, 60] {
        let (p, val) = random(n, 3, 11);
        let mut lu = Lu::new(&p, &vec![1.0; n]);
        lu.factor(&val).expect("regular");
        for allowed in [true, false] {
            lu.may_keep(allowed);
            assert!(error(&mut lu, &p, &val, &vec![1.0; n]) < 1e-10);
            lu.factor(&val).expect("regular");
            assert!(!lu.keeps());
            lu.may_keep(!allowed);
            assert!(error(&mut lu, &p, &val, &vec![1.0; n]) < 1e-10);
        }
    }
}

/// An equation that says nothing while two parts hold, and something as soon as one of them moves.
#[test]
fn an_equation_that_was_empty_comes_back() {
    let (pattern, held) = csc(2, vec![(0, 0, 0.0), (1, 0, -1.0), (0, 1, 0.0), (1, 1, -1.0)]);
    let mut lu = Lu::new(&pattern, &[1.0; 2]);
    lu.may_keep(true);
    lu.factor(&held).expect("one of them is kept");
    assert!(lu.keeps());
    lu.factor(&[1.0, -100.0, 0.0, -1.0]).expect("regular");
    assert!(!lu.keeps());
    let mut x = vec![2.0, -203.0];
    assert!(lu.solve(&mut x));
    assert_eq!(x, [2.0, 3.0]);
}
