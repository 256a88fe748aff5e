//! Slopes of the nominal model of a study beside central differences.
use bramah::internals::diag::Sources;
use bramah::internals::gap::select::models;
use bramah::internals::gap::study::question;
use bramah::internals::study::Study;
use bramah::world::DiskWorld;
use std::path::Path;

fn main() {
    let study = std::env::args().nth(1).unwrap();
    let part: f64 = std::env::args().nth(2).map_or(0.1, |s| s.parse().unwrap_or(0.1));
    let mut sources = Sources::default();
    let study = Study::read(&DiskWorld, Path::new(&study), &mut sources).value.unwrap();
    let asked = question(&DiskWorld, &study, None, &mut sources).ok().unwrap();
    let problem = &asked.problem;
    let mut c = models::nominal(problem).ok().unwrap();
    let x = c.present();
    let t = std::time::Instant::now();
    let e = c.evaluate(&x, &problem.train).unwrap();
    println!("evaluate {:?}", t.elapsed());
    c.off = e.off.clone();
    let t = std::time::Instant::now();
    let _ = c.all_errors(&x, &problem.train).unwrap();
    println!("errors {:?}  states {}", t.elapsed(), c.model.plan.states());
    for (i, s) in problem.signals.iter().enumerate() {
        let sq: f64 = e.errors.iter().flat_map(|e| &e[i]).map(|v| v * v).sum::<f64>()
            / e.errors.iter().map(|e| e[i].len()).sum::<usize>() as f64;
        println!("{} rms {:.4e} noise {:.4e} full {:.4e}", s.name, sq.sqrt(), problem.noise_floor[i], problem.full_scale[i]);
    }
    if std::env::args().nth(2).as_deref() == Some("fit") {
        use bramah::internals::gap::estimate::{Fit, Weights};
        let t = std::time::Instant::now();
        let full = &problem.full_scale;
        let show = |what: &str, f: &Fit| println!("{:7.2} {what} cost {:.3} prior {:.2} ms {:?} x {:?}", t.elapsed().as_secs_f64(), f.cost(), f.prior(),
            f.mean_squares().iter().zip(&c.deviations).map(|(m, d)| format!("{:.3}", m.sqrt() / d)).collect::<Vec<_>>(),
            f.x.iter().zip(&x).map(|(a, b)| format!("{:.2}", a - b)).collect::<Vec<_>>());
        let one = Fit::of(c.clone(), x.clone(), &problem.train, full, None, 1).unwrap();
        show("as they are 1", &one);
        let two = Fit::of(c.clone(), one.x.clone(), &problem.train, full, None, 1).unwrap();
        show("as they are 2", &two);
        let white = Weights::sensors(&problem.noise_floor, full);
        let w = Fit::of(c.clone(), two.x.clone(), &problem.train, full, Some(white), 1).unwrap();
        show("white", &w);
        let three = Fit::of(c.clone(), w.x.clone(), &problem.train, full, None, 1).unwrap();
        show("as they are 3", &three);
        let three = Fit::of(c.clone(), three.x.clone(), &problem.train, full, None, 1).unwrap();
        show("as they are 4", &three);
        println!("ahead of 4 over 2: {}", two.ahead(&three));
        return;
    }
    if let Some(effect) = std::env::args().nth(3).filter(|_| std::env::args().nth(2).as_deref() == Some("effect")) {
        use bramah::internals::gap::estimate::{Fit, Weights};
        use bramah::internals::gap::problem::Chosen;
        let (name, place) = effect.split_once('@').unwrap();
        let h = problem.hypotheses.iter().position(|h| h.effect.contains(name) && h.places().iter().any(|p| p.place == place)).unwrap();
        let values = models::beginnings(&problem.hypotheses[h]).remove(0);
        println!("{} at {:?} from {values:?}", problem.hypotheses[h].effect, place);
        let c = models::candidate(problem, &[Chosen { hypothesis: h, values }], None, 0).unwrap();
        let x = c.present();
        let full = &problem.full_scale;
        let e = c.evaluate(&x, &problem.train).unwrap();
        let t = std::time::Instant::now();
        let show = |what: &str, f: &Fit| println!("{:7.2} {what} cost {:.3} prior {:.2} ms {:?} x {:?}", t.elapsed().as_secs_f64(), f.cost(), f.prior(),
            f.mean_squares().iter().zip(&c.deviations).map(|(m, d)| format!("{:.3}", m.sqrt() / d)).collect::<Vec<_>>(),
            f.x.iter().zip(&x).map(|(a, b)| format!("{:.2}", a - b)).collect::<Vec<_>>());
        let run = |what: &str, first: Weights| {
            let mut f = Fit::rough(c.clone(), x.clone(), &problem.train, &first).unwrap();
            show(&format!("{what} rough"), &f);
            {
                let mut y = f.x.clone();
                y[..problem.tolerances.len()].copy_from_slice(&x[..problem.tolerances.len()]);
                let e = c.evaluate(&y, &problem.train).unwrap();
                let g = Fit { candidate: c.clone(), x: y.clone(), weights: Weights::of(&e.errors, full), evaluated: e };
                show(&format!("{what} reset"), &g);
                let g = Fit::rough(c.clone(), y, &problem.train, &g.weights).unwrap();
                show(&format!("{what} reset, rough"), &g);
                let g = Fit::of(c.clone(), g.x, &problem.train, full, None, 2).unwrap();
                show(&format!("{what} reset, of"), &g);
            }
            for _ in 0..1 {
                f = Fit::of(c.clone(), f.x.clone(), &problem.train, full, None, 1).unwrap();
                show(what, &f);
            }
        };
        run("own", Weights::of(&e.errors, full));
        run("white", Weights::sensors(&problem.noise_floor, full));
        return;
    }
    let m = problem.signals.len();
    let n = x.len();
    println!("{:30} rms slope / rms difference / rms(slope - difference), in deviations of the sensor per tolerance", "");
    for (r, recording) in problem.train.iter().enumerate() {
        let slopes = c.slopes(&x, recording, r).unwrap();
        for k in 0..n {
            let step = part * problem.tolerances[k].sigma / problem.tolerances[k].sigma;
            let at = |d: f64| { let mut y = x.clone(); y[k] += d; c.errors(&y, recording, Some(r)).unwrap() };
            let (lo, hi) = (at(-step), at(step));
            print!("{r} {:28}", problem.tolerances[k].name);
            for i in 0..m {
                let (mut s2, mut d2, mut e2, mut cnt) = (0.0, 0.0, 0.0, 0.0);
                for s in 0..lo[i].len() {
                    let s_ = f64::from(slopes[(s * m + i) * n + k]);
                    let d_ = (lo[i][s] - hi[i][s]) / (2.0 * step);
                    if !d_.is_finite() { continue; }
                    s2 += s_ * s_; d2 += d_ * d_; e2 += (s_ - d_).powi(2); cnt += 1.0;
                }
                let z = |v: f64| (v / cnt).sqrt() / c.deviations[i];
                print!("  {:8.2e} {:8.2e} {:7.1e}", z(s2), z(d2), z(e2));
            }
            println!();
            if std::env::args().nth(3).as_deref() == Some(problem.tolerances[k].name.as_str()) {
                for s in 0..lo[0].len() {
                    print!("   {:9.4}", recording.times[recording.settled() + 1 + s]);
                    for i in 0..m {
                        print!("  {:10.3e} {:10.3e} |", f64::from(slopes[(s * m + i) * n + k]) / c.deviations[i], (lo[i][s] - hi[i][s]) / (2.0 * step) / c.deviations[i]);
                    }
                    println!();
                }
            }
        }
    }
}
