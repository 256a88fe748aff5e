//! The language: small models, and what the standard says of them.

use bramah::Interpolation;
use bramah::Simulation;

fn run(text: &str) -> bramah::results::Trajectory {
    let simulation = Simulation::from_text(text).unwrap_or_else(|e| panic!("{e}"));
    simulation.run().unwrap_or_else(|e| panic!("{e}")).trajectory
}

/// Modelica 3.6, 7.4: a component that is left out takes its connections with it.
#[test]
fn a_broken_component_takes_its_connections_along() {
    let run = run("
package P
  partial model Base
    Mechanical.Rotational.Inertia inertia(J = 1, phi(fixed = true), w(fixed = true, start = 1));
    Mechanical.Rotational.Damper slow(d = 1);
    Mechanical.Rotational.Fixed wall;
  equation
    connect(inertia.flange_b, slow.flange_a);
    connect(slow.flange_b, wall.flange);
  end Base;
  partial model Between
    extends Base;
    Mechanical.Rotational.Torque off;
  equation
    off.tau = 0;
    connect(off.flange, slow.flange_a);
  end Between;
  model M
    extends Between(break slow);
    Mechanical.Rotational.Damper fast(d = 2);
  equation
    connect(inertia.flange_b, fast.flange_a);
    connect(fast.flange_b, wall.flange);
    connect(inertia.flange_b, off.flange);
  end M;
end P;");
    let speed = run.column("inertia.w").expect("a variable").last().expect("a row");
    assert!((speed - (-2.0f64).exp()).abs() < 1e-5, "{speed}");
}

/// Modelica 3.6, 7.4: the connection with the same ports, subscripts included.
#[test]
fn a_broken_connection_is_the_one_with_its_subscripts() {
    let run = run("
package P
  partial model Base
    Mechanical.Rotational.Inertia inertia[2](each J = 1, each w(fixed = true, start = 1));
    Mechanical.Rotational.Damper slow[2](each d = 1);
    Mechanical.Rotational.Fixed wall;
  equation
    connect(inertia[1].flange_b, slow[1].flange_a);
    connect(inertia[2].flange_b, slow[2].flange_a);
    connect(slow[1].flange_b, wall.flange);
    connect(slow[2].flange_b, wall.flange);
  end Base;
  model M
    extends Base(break connect(inertia[2].flange_b, slow[2].flange_a));
    Mechanical.Rotational.Damper fast(d = 1);
  equation
    connect(inertia[2].flange_b, fast.flange_a);
    connect(fast.flange_b, slow[2].flange_a);
  end M;
end P;");
    let speed = |name: &str| *run.column(name).expect("a variable").last().expect("a row");
    assert!((speed("inertia[1].w") - (-1.0f64).exp()).abs() < 1e-5, "{}", speed("inertia[1].w"));
    assert!((speed("inertia[2].w") - (-0.5f64).exp()).abs() < 1e-5, "{}", speed("inertia[2].w"));
}

/// An input may move a shaft whatever the order in which components are declared.
#[test]
fn an_input_moves_a_shaft_that_others_watch() {
    let mut simulation = Simulation::from_text(
        "
model M
  Mechanical.Rotational.SpeedSensor first;
  Mechanical.Rotational.Speed shaft;
  Mechanical.Rotational.SpeedSensor last;
  input Real n;
equation
  n = shaft.w_ref;
  connect(first.flange, shaft.flange);
  connect(shaft.flange, last.flange);
end M;",
    )
    .unwrap_or_else(|e| panic!("{e}"));
    simulation.input("n", &[0.0, 1.0], &[0.0, 2.0], Interpolation::Linear).expect("an input");
    let run = simulation.run().unwrap_or_else(|e| panic!("{e}")).trajectory;
    let last = |name: &str| *run.column(name).expect("a variable").last().expect("a row");
    assert!((last("shaft.phi") - 1.0).abs() < 1e-6, "{}", last("shaft.phi"));
    assert_eq!((last("first.w"), last("last.w")), (2.0, 2.0));
}

/// Within its play a backlash leaves a joint without inertia to its own drag.
#[test]
fn a_joint_without_inertia_follows_its_spring() {
    let run = run("
model M
  Mechanical.Rotational.Inertia mass(J = 1, phi(fixed = true), w(fixed = true, start = 1));
  Mechanical.Rotational.ElastoBacklash play(b = 0.02, c = 1e3, d = 5, d_play = 1e-3, phi_rel(fixed = true));
  Mechanical.Rotational.Spring spring(c = 100);
  Mechanical.Rotational.Fixed wall;
equation
  connect(mass.flange_b, play.flange_a);
  connect(play.flange_b, spring.flange_a);
  connect(spring.flange_b, wall.flange);
  annotation(experiment(StopTime = 0.35));
end M;");
    let (joint, shaft) =
        (run.column("spring.flange_a.phi").expect("the joint"), run.column("mass.phi").expect("the shaft"));
    // the play closes and the springs, one behind the other, turn the mass back; contact lost, the joint goes home
    assert!(joint.iter().fold(0.0f64, |a, b| a.max(b.abs())) > 0.05, "the contact carries");
    assert!(shaft.last().is_some_and(|phi| phi.abs() < 0.01) && joint.last().is_some_and(|phi| phi.abs() < 1e-3));
}
