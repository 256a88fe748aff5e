within Signal;
block Measured "A measured value: gain, offset, lag, noise and sampling on a true one"
  extends Bases.OneToOne;
  parameter Real gain = 1 "Gain";
  parameter Real offset = 0 "Offset";
  parameter SI.Time tau(min = 1e-9) = 1e-3 "Time constant of the sensor";
  parameter SI.Time samplePeriod(min = 1e-9) = 1e-3 "Sampling period";
  parameter Real std(min = 0) = 0 "Standard deviation of the noise";
  parameter Integer delay(min = 0, max = 16) = 0 "Samples that the value arrives late";
  parameter Integer seed(min = 1, max = 2147483646) = 1 "Seed of the noise";
  Real x "Value behind the lag";
protected
  discrete Real state(start = seed, fixed = true, nominal = 1e9) "State of the noise";
  discrete Real late[17] "Last samples";
initial equation
  x = gain*u + offset;
  pre(y) = x;
  for i in 1:17 loop
    pre(late[i]) = x;
  end for;
equation
  assert(tau > 0 and samplePeriod > 0, "tau and samplePeriod must be positive");
  tau*der(x) = gain*u + offset - x;
  when sample(0, samplePeriod) then
    state = mod(16807*pre(state), 2147483647.0);
    late[1] = x + std*sqrt(12)*(state/2147483647.0 - 0.5);
    for i in 2:17 loop
      late[i] = pre(late[i - 1]);
    end for;
    y = late[delay + 1];
  end when;
  annotation(Documentation(info = "<html><p>What a measuring chain makes of a value, in this order: gain and offset, a lag of first order, samples every <code>samplePeriod</code>, white noise of the standard deviation <code>std</code> (even distribution), and a delay of whole samples. The noise comes from a generator of its own and is the same in every run with the same seed. The chain has been on for long when a run starts: lag and delay hold the first value.</p></html>"));
end Measured;
