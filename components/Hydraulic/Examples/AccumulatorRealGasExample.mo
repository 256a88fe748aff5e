within Hydraulic.Examples;
model AccumulatorRealGasExample "An accumulator of high pressure charged and discharged"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 1.2e-4, f = 0.2);
  FlowSource source(useInput = true);
  AccumulatorRealGas accumulator(V_0 = 1e-3, p_pre = 200e5, p_start = 200e5, fill = 0.8);
equation
  connect(sine.y, source.q_in);
  connect(source.port, accumulator.port);
  annotation(experiment(StartTime = 0, StopTime = 30, Interval = 0.06, Tolerance = 1e-6));
end AccumulatorRealGasExample;
