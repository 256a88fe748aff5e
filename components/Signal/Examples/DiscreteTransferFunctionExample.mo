within Signal.Examples;
model DiscreteTransferFunctionExample "A sampled notch at 50 Hz takes it out of a step"
  Step step(height = 1, startTime = 0.05);
  Sine hum(f = 50, amplitude = 0.3);
  Add add;
  DiscreteTransferFunction notch(
    samplePeriod = 1e-3,
    b = {1, -2*cos(0.1*Modelica.Constants.pi), 1}*(1 - 2*0.9*cos(0.1*Modelica.Constants.pi) + 0.81)/(2 - 2*cos(0.1*Modelica.Constants.pi)),
    a = {1, -2*0.9*cos(0.1*Modelica.Constants.pi), 0.81});
equation
  connect(step.y, add.u1);
  connect(hum.y, add.u2);
  connect(add.y, notch.u);
  annotation(experiment(StartTime = 0, StopTime = 0.3, Interval = 5e-4, Tolerance = 1e-6));
end DiscreteTransferFunctionExample;
