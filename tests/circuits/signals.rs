//! Logic of cycles, sampled and continuous filters: against what they must do.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::rig;

use rig::{at, circuit, column, last, near, run, shipped};

#[test]
fn a_cycle_goes_out_waits_and_comes_back() {
    let t = run(&shipped("Signal.Examples.SequenceExample"));
    assert_eq!(last(&t, "strokes.y"), 3.0);
    // the switch at 0.299 m is reached after 1.495 s, the wait ends 0.5 s later; then from 0.3 to 0.001 and out again
    near(at(&t, "lastStroke.y", 4.0), 1.995, 1e-6);
    let round = 1.495 + 1.49 + 0.5;
    near(at(&t, "lastStroke.y", 8.0), 1.995 + round, 2e-3);
    assert!(column(&t, "position.y").iter().all(|x| (-1e-9..=0.3 + 1e-9).contains(x)));
}

#[test]
fn the_timer_and_the_memory_keep_their_order() {
    let t = run(circuit(
        "Signal.Pulse pulse(period = 1, width = 0.3); Signal.GreaterThreshold high(threshold = 0.5);
         Signal.OnDelay short(delay = 0.2); Signal.OnDelay long(delay = 0.4); Signal.FlipFlop memory;
         Signal.EdgeCounter edges; Signal.TriggeredSampler kept;",
        "connect(pulse.y, high.u); connect(high.y, short.u); connect(high.y, long.u); connect(short.y, memory.set);
         memory.reset = time > 2.5; connect(high.y, edges.u); connect(short.y, kept.trigger); kept.u = time;",
    )
    .stop_time(4.0));
    // the pulse lasts 0.3 s of each second
    for (time, wanted) in [(-0.85, 0.0), (-0.75, 1.0), (0.15, 0.0), (0.25, 1.0), (0.35, 0.0)] {
        assert_eq!(at(&t, "short.y", 1.0 + time), wanted, "{time}");
    }
    assert!(column(&t, "long.y").iter().all(|y| *y == 0.0));
    for (time, wanted) in [(0.1, 0.0), (1.1, 1.0), (2.4, 1.0), (2.6, 0.0), (3.9, 0.0)] {
        assert_eq!(at(&t, "memory.y", time), wanted, "{time}");
    }
    near(at(&t, "kept.y", 2.9), 2.2, 1e-9);
    assert!(last(&t, "edges.y") >= 3.0);
}

#[test]
fn the_sampled_notch_takes_out_its_frequency_and_keeps_the_mean() {
    let t = run(&shipped("Signal.Examples.DiscreteTransferFunctionExample"));
    for time in [0.22, 0.2555, 0.29] {
        near(at(&t, "notch.y", time), 1.0, 1e-6);
    }
}

#[test]
fn the_butterworth_filter_is_3_db_down_at_its_corner() {
    for sections in [1, 2, 3] {
        for (f, wanted) in [(20.0, (1.0 + 0.2f64.powi(4 * sections)).sqrt().recip()), (100.0, 0.5f64.sqrt())] {
            let mut simulation = circuit(
                &format!(
                    "Signal.Sine sine(f = {f}); Signal.Butterworth filter(f_c = 100, sections = {sections});
                     Real square(start = 0, fixed = true);"
                ),
                "connect(sine.y, filter.u); der(square) = filter.y^2;",
            );
            simulation.stop_time(0.3);
            simulation.settings().tolerance = 1e-8;
            let t = run(&simulation);
            let rms = ((at(&t, "square", 0.3) - at(&t, "square", 0.2)) / 0.1).sqrt();
            near(rms * 2f64.sqrt(), wanted, 1e-4);
        }
    }
}
