within Hydraulic;
model FlowSource "Volume flow given by a parameter or a signal"
  parameter Boolean useInput = false "true: the flow comes through q_in" annotation(Evaluate = true);
  parameter SI.VolumeFlowRate q(nominal = 1e-4) = 1e-4 "Volume flow out of the port, without signal";
  parameter SI.TemperatureDifference dT(min = -100, max = 150) = 0 "Temperature of its oil above T_0, where oil carries heat";
  outer Oil.Fluid oil "Oil of the circuit";
  Interfaces.HydraulicPort port(dT_outflow = dT) "Port";
  Interfaces.RealInput q_in(unit = "m3/s") if useInput "Volume flow out of the port, at its pressure";
protected
  Interfaces.RealInput q_used(unit = "m3/s");
  SI.Density rho(nominal = 1000) "Density at the port";
equation
  connect(q_in, q_used);
  if not useInput then
    q_used = q;
  end if;
  assert(q_used >= 0 or rho > 1e-3*oil.rho_l, "The source takes " + String(-6e4*q_used) + " l/min out of a node that holds vapour only: its density has fallen to a thousandth. Nothing, or too little, flows in there");
  assert(q_used <= 0 or port.p < 1e9, "The source presses " + String(6e4*q_used) + " l/min into a place that lets too little out: its pressure exceeds 10000 bar. Is a valve shut, or built in the wrong way round? A relief valve would open");
  assert(q_used >= 0 or port.p > oil.p_void, "The oil cavitates: the source draws more than flows in, and voids open in the oil. Is a valve shut, or a restriction too narrow?", AssertionLevel.warning);
  port.q = -max(q_used, 0)*max(0.9*oil.rho_l/rho, 1) - min(q_used, 0);
  rho = oil.density(port.p);
  annotation(Documentation(info = "<html><p>Gives any pressure that the flow needs; join it to a volume or a restriction. A positive flow leaves the port, into voids as oil of nine tenths of its density at least, so that it fills them; a negative one is drawn, counted at the pressure of the port: with a warning where it draws voids along, and an error where voids are a thousand times the oil, since no pressure gives what it asks for.</p></html>"));
end FlowSource;
