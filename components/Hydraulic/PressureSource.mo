within Hydraulic;
model PressureSource "Pressure given by a parameter or a signal"
  parameter Boolean useInput = false "true: the pressure comes through p_in" annotation(Evaluate = true);
  parameter SI.Pressure p(nominal = 1e6) = 1e6 "Pressure without signal";
  parameter SI.TemperatureDifference dT(min = -100, max = 150) = 0 "Temperature of its oil above T_0, where oil carries heat";
  Interfaces.HydraulicPort port(dT_outflow = dT) "Port" annotation(__bramah_mixes = true);
  Interfaces.RealInput p_in(unit = "Pa") if useInput "Pressure";
protected
  Interfaces.RealInput p_used(unit = "Pa");
equation
  connect(p_in, p_used);
  if not useInput then
    p_used = p;
  end if;
  assert(p_used >= 0, "The pressure of the source is absolute and cannot be " + String(1e-5*p_used) + " bar: add the pressure of the surroundings to one that counts from there");
  port.p = p_used;
  annotation(Documentation(info = "<html><p>Takes and gives any flow at the pressure given.</p></html>"));
end PressureSource;
