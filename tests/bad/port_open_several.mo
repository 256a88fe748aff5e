//! E103 at 7: "port `valve.port_P` is not connected"
//! E103 at 7: "port `valve.port_T` is not connected"
//! E103 at 8: "port `orifice[1].port_b` is not connected"
// Each open port of a component is told, the same one of several instances once.
model M
  inner Oil.Fluid oil;
  Hydraulic.Valve43 valve(u = 0);
  Hydraulic.Orifice orifice[2];
equation
  connect(valve.port_A, orifice[1].port_a);
  connect(valve.port_B, orifice[2].port_a);
end M;
