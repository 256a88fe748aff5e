within ClosedCircuit;
type Control = enumeration(
  V_f "Voltage in proportion to frequency",
  SFVC "Sensorless flux vector control",
  SFVC_reduced "The same, torque and estimated speed as lags") "Control of the drive";
