within Pneumatic;
model PressureSource "Pressure given by a parameter or a signal"
  parameter Boolean useInput = false "true: the pressure comes through p_in" annotation(Evaluate = true);
  parameter SI.Pressure p(min = 0, max = 1e8, nominal = 1e5, displayUnit = "bar") = 7e5 "Pressure without signal, absolute";
  parameter SI.Temperature T(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature of gas that leaves";
  outer Gas gas "Gas of the circuit";
  PneumaticPort port "Port";
  Interfaces.RealInput p_in(unit = "Pa") if useInput "Pressure, absolute";
protected
  Interfaces.RealInput p_used(unit = "Pa");
equation
  assert(T > 0, "The temperature T must be positive");
  connect(p_in, p_used);
  if not useInput then
    p_used = p;
  end if;
  port.p = p_used;
  port.h_outflow = gas.c_p*T;
  annotation(Documentation(info = "<html><p>Takes and gives any flow at the pressure given; gas leaves with the temperature T.</p></html>"));
end PressureSource;
