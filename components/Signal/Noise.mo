within Signal;
block Noise "White noise, uniform, from a seed: the same numbers in every run"
  extends Bases.Source(y(start = 0, fixed = true));
  parameter SI.Time samplePeriod(min = 1e-9) = 1e-3 "Time between two numbers";
  parameter Real std(min = 0) = 1 "Standard deviation";
  parameter Integer seed(min = 1, max = 2147483646) = 1 "Seed";
  discrete Real state(start = seed, fixed = true, nominal = 1e9) "State of the generator";
equation
  assert(samplePeriod > 0, "The sampling period must be positive");
  when sample(0, samplePeriod) then
    state = mod(16807*pre(state), 2147483647.0);
    y = std*sqrt(12)*(state/2147483647.0 - 0.5);
  end when;
  annotation(Documentation(info = "<html><p>Lehmer's generator of multiplier 16807 and modulus 2^31 - 1; all products stay exact in double precision.
Source: S. K. Park and K. W. Miller, Commun. ACM 31 (1988) 1192.</p></html>"));
end Noise;
