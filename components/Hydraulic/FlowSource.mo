within Hydraulic;
model FlowSource "Volume flow given by a parameter or a signal"
  parameter Boolean useInput = false "true: the flow comes through q_in" annotation(Evaluate = true);
  parameter SI.VolumeFlowRate q(nominal = 1e-4) = 1e-4 "Volume flow out of the port, without signal";
  parameter SI.TemperatureDifference dT(min = -100, max = 150) = 0 "Temperature of its oil above T_0, where oil carries heat";
  Interfaces.HydraulicPort port(dT_outflow = dT) "Port";
  Interfaces.RealInput q_in(unit = "m3/s") if useInput "Volume flow out of the port, at its pressure";
protected
  Interfaces.RealInput q_used(unit = "m3/s");
equation
  connect(q_in, q_used);
  if not useInput then
    q_used = q;
  end if;
  port.q = -q_used;
  annotation(Documentation(info = "<html><p>Gives any pressure that the flow needs; join it to a volume or a restriction. A positive flow leaves the port.</p></html>"));
end FlowSource;
