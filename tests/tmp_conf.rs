mod diagnose;
#[test]
fn conf() {
    for part in ["language", "networks"] {
        let dir = format!("/work/shared/conformance/{part}");
        let suite: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(format!("{dir}/suite.json")).unwrap()).unwrap();
        for e in suite.as_array().unwrap() {
            let file = e["file"].as_str().unwrap();
            let text = std::fs::read_to_string(format!("{dir}/{file}")).unwrap();
            let r = diagnose::report(&text, e["model"].as_str(), false);
            for d in r.faults() {
                println!("{file} {} {:?} {}", d.code, r.place(d), d.message);
                for l in d.labels.iter().map(|l| &l.text).chain(&d.notes) {
                    println!("       {l}");
                }
            }
        }
    }
    let world = bramah::shipped::Shipped;
    for (root) in ["components", "models"] {
        walk(&world, std::path::Path::new(root), &mut vec![]);
    }
}
fn walk(world: &dyn bramah::world::World, path: &std::path::Path, _v: &mut Vec<String>) {
    for (name, dir) in world.list(path).unwrap() {
        let p = path.join(&name);
        if dir {
            walk(world, &p, _v);
            continue;
        }
        if !name.ends_with(".mo") || name == "package.mo" {
            continue;
        }
        let class = p
            .with_extension("")
            .components()
            .skip(1)
            .map(|c| c.as_os_str().to_string_lossy().into_owned())
            .collect::<Vec<_>>()
            .join(".");
        let o = bramah::flatten(world, &bramah::Request { source: class.clone().into(), ..Default::default() });
        for d in o.diagnostics.iter().filter(|d| d.severity > bramah::diag::Severity::Note) {
            if matches!(d.code.id(), "E018" | "E022") {
                continue;
            }
            println!("{class} {} {}", d.code, d.message);
            for l in d.labels.iter().map(|l| &l.text).chain(&d.notes) {
                println!("       {l}");
            }
        }
    }
}
