within Pneumatic;
model Atmosphere "Surroundings: reference atmosphere of the gas"
  PneumaticPort port "Port";
  outer Gas gas "Gas of the circuit";
equation
  port.p = gas.p_0;
  port.h_outflow = gas.c_p*gas.T_0;
  annotation(Documentation(info = "<html><p>Takes and gives any mass at <code>gas.p_0</code>; gas drawn in has <code>gas.T_0</code>. Other values: <code>Reservoir</code>.</p></html>"));
end Atmosphere;
