within Electrical.Drives;
model Encoder "Incremental encoder: speed from counted lines"
  Interfaces.RotationalFlange flange "Shaft";
  Interfaces.RealOutput w(unit = "rad/s", start = 0, fixed = true) "Measured speed";
  parameter Integer N_c(min = 1) = 10000 "Counts per revolution";
  parameter SI.Time T_s(min = 1e-6) = 0.625e-3 "Sampling period";
  discrete Real counts(start = 0) "Counted lines at the last sample";
initial equation
  pre(counts) = floor(N_c*flange.phi/(2*Modelica.Constants.pi));
equation
  assert(N_c > 0 and T_s > 0, "Counts N_c and sampling period T_s must be positive");
  flange.tau = 0;
  when sample(0, T_s) then
    counts = floor(N_c*flange.phi/(2*Modelica.Constants.pi));
    w = 2*Modelica.Constants.pi/N_c*(counts - pre(counts))/T_s;
  end when;
  annotation(Documentation(info = "<html><p>Resolution <code>60/(N_c T_s)</code> r/min: 9.6 r/min with the defaults. Below one line per sample the speed is told in pulses. No errors of the lines themselves.</p></html>"));
end Encoder;
