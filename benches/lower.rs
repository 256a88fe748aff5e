//! How long lowering takes and how fast its kernels run: a line of N volumes and orifices, native and interpreted.

#![allow(missing_docs, reason = "criterion_group makes a public function")]

use bramah::Request;
use bramah::internals::compile::sort;
use bramah::internals::lower::{ExecutableSystem, LoweringOptions, lower};
use bramah::internals::structure::Dae;
use bramah::world::MemoryWorld;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::sync::Arc;

/// N volumes in a row with orifices between them, fed by a flow that rises and falls.
const LINE: &str = r#"
package Bench
  connector Port
    Real p(unit = "Pa", nominal = 1e5);
    flow Real q(unit = "m3/s");
  end Port;
  model Volume
    Port a;
    parameter Real C(unit = "m3/Pa") = 1e-13;
    Real p(unit = "Pa", start = 1e5, fixed = true);
  equation
    p = a.p;
    C*(1 + exp(-a.p/2e5))*der(p) = a.q;
  end Volume;
  model Orifice
    Port a;
    Port b;
    parameter Real G = 1e-6;
    Real dp(unit = "Pa");
  equation
    dp = a.p - b.p;
    a.q = G*sqrt(2/870)*dp/(dp*dp + 1e6)^0.25;
    a.q + b.q = 0;
  end Orifice;
  model Source
    Port a;
  equation
    a.q = -1e-4*(1 + sin(6*time));
  end Source;
  model Tank
    Port a;
  equation
    a.p = 1e5;
  end Tank;
  model Line
    parameter Integer N = SECTIONS;
    Source source;
    Volume v[N];
    Orifice o[N];
    Tank tank;
  equation
    connect(source.a, v[1].a);
    for i in 1:N loop
      connect(v[i].a, o[i].a);
    end for;
    for i in 1:N - 1 loop
      connect(o[i].b, v[i + 1].a);
    end for;
    connect(o[N].b, tank.a);
  end Line;
end Bench;
"#;

fn line(sections: usize) -> Arc<Dae> {
    let world = MemoryWorld::single("Bench.mo", LINE.replace("SECTIONS", &sections.to_string()));
    let request = Request { source: "Bench.mo".into(), model: Some("Bench.Line".into()), ..Request::default() };
    let outcome = sort(&world, &request);
    let messages: Vec<&str> = outcome.diagnostics.iter().map(|d| d.message.as_str()).collect();
    let (_, _, dae) = outcome.value.unwrap_or_else(|| panic!("{}", messages.join("\n")));
    Arc::new(dae)
}

fn lowering(c: &mut Criterion) {
    let mut group = c.benchmark_group("lower");
    group.sample_size(10);
    for sections in [10, 100, 1000] {
        let dae = line(sections);
        group.throughput(Throughput::Elements(sections as u64));
        for native in [false, true] {
            let id = BenchmarkId::new(way(native), sections);
            group.bench_function(id, |b| {
                b.iter(|| lower(black_box(dae.clone()), &LoweringOptions { native, ..LoweringOptions::default() }))
            });
        }
    }
}

fn kernels(c: &mut Criterion) {
    for sections in [10, 1000] {
        let dae = line(sections);
        for native in [false, true] {
            let system = lower(dae.clone(), &LoweringOptions { native, ..LoweringOptions::default() });
            evaluate(c, &system, &format!("{}/{sections}", way(native)));
        }
    }
}

fn evaluate(c: &mut Criterion, system: &ExecutableSystem, name: &str) {
    let n = system.columns.len();
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    let y: Vec<f64> = (0..n).map(|i| 1e5 + 1e3 * (i % 7) as f64).collect();
    let yp = vec![0.0; n];
    let (mut r, mut matrix) = (vec![0.0; n], vec![0.0; system.pattern.nnz()]);
    c.bench_function(&format!("residual/{name}"), |b| {
        b.iter(|| system.residual(0.1, black_box(&y), &yp, &mut values, &mut r));
    });
    c.bench_function(&format!("jacobian/{name}"), |b| {
        b.iter(|| system.jacobian(0.1, 1e3, black_box(&y), &yp, &mut values, &mut matrix));
    });
    c.bench_function(&format!("observe/{name}"), |b| {
        b.iter(|| system.observe(0.1, black_box(&y), &yp, &mut values));
    });
}

fn way(native: bool) -> &'static str {
    if native { "native" } else { "interpreted" }
}

criterion_group!(benches, lowering, kernels);
criterion_main!(benches);
