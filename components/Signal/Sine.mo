within Signal;
block Sine "Sine"
  extends Bases.Source;
  parameter Real amplitude = 1 "Amplitude";
  parameter SI.Frequency f(min = 0) = 1 "Frequency";
  parameter SI.Angle phase = 0 "Phase";
  parameter Real offset = 0 "Mean value";
  parameter SI.Time startTime = 0 "Constant at the offset before";
equation
  y = offset + (if time < startTime then 0 else amplitude*sin(2*Modelica.Constants.pi*f*(time - startTime) + phase));
  annotation(Documentation(info = "<html><p><code>offset + amplitude sin(2 pi f (t - startTime) + phase)</code> from the start time on.</p></html>"));
end Sine;
