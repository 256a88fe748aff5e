//! E503 at 4: "The precharge p_pre must lie below p_max"
model M
  inner Oil.Fluid oil;
  Hydraulic.AccumulatorPolytropic accumulator(p_pre = 250e5, p_max = 200e5);
  Hydraulic.Plug plug;
equation
  connect(accumulator.port, plug.port);
end M;
