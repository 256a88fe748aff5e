within Signal;
block Chirp "Sine whose frequency grows linearly"
  extends Bases.Source;
  parameter Real amplitude = 1 "Amplitude";
  parameter SI.Frequency f_1(min = 0) = 0.1 "Frequency at the start";
  parameter SI.Frequency f_2(min = 0) = 10 "Frequency at the end";
  parameter SI.Time duration(min = 1e-6) = 10 "Time from f_1 to f_2";
  parameter Real offset = 0 "Mean value";
  parameter SI.Time startTime = 0 "Constant at the offset before";
protected
  SI.Time t "Time since the start";
equation
  t = time - startTime;
  y = offset + (if time < startTime then 0 else amplitude*sin(2*Modelica.Constants.pi*(f_1 + (f_2 - f_1)*t/(2*duration))*t));
  annotation(Documentation(info = "<html><p>A sine whose frequency grows linearly from <code>f_1</code> to <code>f_2</code> over <code>duration</code>, and on beyond.</p></html>"));
end Chirp;
