//! The benches whose parameters are found again and again: what is run, how, and what is searched for.

/// An input and its trajectory, one value a sample; straight lines between samples unless it is held.
pub struct Driven {
    /// Its name in the model.
    pub name: &'static str,
    /// Values at the samples.
    pub values: Vec<f64>,
    /// Whether a value holds until the next sample.
    pub held: bool,
}

/// A model on a bench.
pub struct Bench {
    /// The model `Bench`.
    pub model: &'static str,
    /// The study's tables of inputs, signals and parameters.
    pub study: &'static str,
    /// Seconds between samples.
    pub interval: f64,
    /// What drives it.
    pub inputs: Vec<Driven>,
    /// What is measured.
    pub signals: &'static [&'static str],
    /// The parameters searched for, in the order of the study, with the truth.
    pub truth: &'static [(&'static str, f64)],
}

/// A bench by its name.
pub fn named(name: &str) -> Option<Bench> {
    match name {
        "drive" => Some(drive()),
        "pump" => Some(pump()),
        "machine" => Some(machine()),
        _ => None,
    }
}

/// A pump with leakage presses into a volume with a load orifice; the speed follows its command.
fn drive() -> Bench {
    let command = (0..400).map(|k| [500.0, 1500.0, 900.0, 1200.0][k / 50 % 4]).collect();
    Bench {
        model: "
model Bench
  parameter Real T(unit = \"s\", min = 0) = 0.03 \"Time constant of the drive\";
  parameter Real G(unit = \"l/(min.bar)\", min = 0) = 0.02 \"Leakage\";
  parameter Real q0(unit = \"l/min\") = 0 \"Offset of the flow sensor\";
  parameter Real D(unit = \"l\") = 0.01 \"Displacement\";
  parameter Real C(unit = \"l/bar\") = 2e-4 \"Capacity\";
  parameter Real R(unit = \"l/(min.bar0.5)\") = 0.8 \"Load\";
  input Real n_c(unit = \"1/min\");
  Real n(unit = \"1/min\", start = 500, fixed = true);
  Real p(unit = \"bar\", start = 30, fixed = true);
  output Real q(unit = \"l/min\");
equation
  T*der(n) = n_c - n;
  60*C*der(p) = D*n - G*p - R*sqrt(p);
  q = R*sqrt(p) + q0;
end Bench;",
        study: r#"
[inputs]
n_c = { unit = "1/min", hold = true }
[signals]
q = { unit = "l/min" }
p = { unit = "bar" }
[parameters]
T = { min = 0.001, max = 1 }
G = { min = 0.0, max = 1 }
q0 = { min = -1, max = 1 }
"#,
        interval: 0.005,
        inputs: vec![Driven { name: "n_c", values: command, held: true }],
        signals: &["q", "p"],
        truth: &[("T", 0.04), ("G", 0.03), ("q0", 0.05)],
    }
}

/// The servo pump: 80 s with the valve closed while the speed rises (its dead zone), then six speeds against a throttle.
fn pump() -> Bench {
    const RISE: usize = 400;
    let speed = |k: usize| if k < RISE { 0.1 * k as f64 } else { 500.0 * (1 + (k - RISE) / 20) as f64 };
    let samples = 0..RISE + 120;
    Bench {
        model: "
model Bench
  input Real N(unit = \"rev/min\");
  input Real opening(unit = \"1\");
  output Real p(unit = \"Pa\", nominal = 1e7);
  output Real Q(unit = \"m3/s\", nominal = 1e-5);
  inner Oil.ServoPumpOil oil(T_0 = Modelica.Units.Conversions.from_degC(35));
  Mechanical.Rotational.Speed motor;
  ServoPump.BenchPump pump(sigma = 4e-8, G = 1.5e-14, Q_0 = 1e-7);
  Hydraulic.Volume volume(V = 50e-6, p_start = 5e5);
  Hydraulic.FlowSensor meter;
  Hydraulic.VariableOrifice valve(A_max = 4e-7, A_leak = 1e-16);
  Hydraulic.Tank reservoir(p = 5e5);
equation
  motor.w_ref = Modelica.Units.Conversions.from_rpm(N);
  valve.u = opening;
  connect(motor.flange, pump.flange);
  connect(reservoir.port, pump.port_b);
  connect(pump.port_a, volume.port);
  connect(volume.port, meter.port_a);
  connect(meter.port_b, valve.port_a);
  connect(valve.port_b, reservoir.port);
  p = volume.p;
  Q = meter.q;
end Bench;",
        study: r#"
[inputs]
N = { unit = "rev/min", hold = false }
opening = { unit = "1", hold = false }
[signals]
p = { unit = "Pa" }
Q = { unit = "m3/s" }
[parameters]
"pump.sigma" = { min = 0.0, max = 1e-6 }
"pump.G" = { min = 1e-16, max = 1e-12 }
"pump.Q_0" = { min = 0.0, max = 1e-5 }
"#,
        interval: 0.2,
        inputs: vec![
            Driven { name: "N", values: samples.clone().map(speed).collect(), held: false },
            Driven { name: "opening", values: samples.map(|k| f64::from(u8::from(k >= RISE))).collect(), held: false },
        ],
        signals: &["p", "Q"],
        truth: &[("pump.sigma", 3.178e-8), ("pump.G", 1.842e-14), ("pump.Q_0", 1.3835e-7)],
    }
}

/// The machine of the closed circuit: efficiencies over 8 speeds at each of 8 pressures, 4 readings of each point.
/// Slippers and plate are known; what flow and torque cannot tell apart is said by `tests/circuits/machines.rs`.
fn machine() -> Bench {
    let point = |k: usize| (k / 32, k / 4 % 8);
    let pressure = |k| 2.5e6 * (1 + point(k).0) as f64 + 2e6;
    let speed = |k| 280.0 + 160.0 * point(k).1 as f64;
    Bench {
        model: "
model Bench
  input Real N(unit = \"rev/min\");
  input Real p(unit = \"Pa\");
  output Real eta_v(unit = \"1\");
  output Real eta_m(unit = \"1\");
  inner Oil.ClosedCircuitOil oil;
  Mechanical.Rotational.Speed drive;
  ClosedCircuit.BenchMachine pump(h_p = 20e-6, w_p = 0.6, w_v = 0.7);
  Hydraulic.PressureSource high(useInput = true);
  Hydraulic.Tank low(p = 2e6);
protected
  Real ideal(unit = \"W\", nominal = 1e4);
equation
  drive.w_ref = Modelica.Units.Conversions.from_rpm(N);
  high.p_in = p;
  connect(drive.flange, pump.flange);
  connect(pump.port_a, high.port);
  connect(pump.port_b, low.port);
  ideal = pump.V*pump.w/(2*Modelica.Constants.pi)*(p - 2e6);
  eta_v*ideal = pump.Q_A*(p - 2e6);
  eta_m*pump.T_sh*pump.w = ideal;
end Bench;",
        study: r#"
[inputs]
N = { unit = "rev/min", hold = true }
p = { unit = "Pa", hold = true }
[signals]
eta_v = { unit = "1" }
eta_m = { unit = "1" }
[parameters]
"pump.h_p" = { min = 5e-6, max = 50e-6 }
"pump.w_p" = { min = 0.0, max = 1.0 }
"pump.w_v" = { min = 0.0, max = 1.0 }
"#,
        interval: 1.0,
        inputs: vec![
            Driven { name: "N", values: (0..256).map(speed).collect(), held: true },
            Driven { name: "p", values: (0..256).map(pressure).collect(), held: true },
        ],
        signals: &["eta_v", "eta_m"],
        truth: &[("pump.h_p", 24e-6), ("pump.w_p", 0.7), ("pump.w_v", 0.75)],
    }
}
