//! E302 at 6: "nothing fixes the pressure level of {"
//! run
// Densities depend on the pressures, so that the equations look regular.
model M
  inner Oil.ISOVG46 oil;
  Hydraulic.FlowSource push(q = 1e-4);
  Hydraulic.FlowSource pull(q = -1e-4);
  Hydraulic.Orifice throttle;
equation
  connect(push.port, throttle.port_a);
  connect(throttle.port_b, pull.port);
end M;
