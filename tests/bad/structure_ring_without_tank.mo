//! E302 at 4: "nothing fixes the pressure level of {pump, filter, valve"
model M
  inner Oil.ISOVG46 oil;
  Hydraulic.Pump pump;
  Mechanical.Rotational.ConstantSpeed motor(w_fixed = 100);
  Hydraulic.Filter filter;
  Hydraulic.Orifice valve(A = 1e-6);
equation
  connect(motor.flange, pump.flange);
  connect(pump.port_a, filter.port_a);
  connect(filter.port_b, valve.port_a);
  connect(valve.port_b, pump.port_b);
end M;
