within Hydraulic.PumpControl;
model FlowControl "Flow control: the displacement that gives a commanded flow at the present speed, below a pressure cut-off"
  extends Law;
  Interfaces.RealInput q_ref(unit = "m3/s") "Flow commanded";
  Interfaces.RealInput w(unit = "rad/s") "Speed of the shaft, measured";
  parameter SI.AngularVelocity w_min(min = 0.1, max = 1e3, nominal = 10) = 10 "Speed below which the displacement is not raised further";
  parameter Real G(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 0 "Leakage of the pump over pressure that is made up for";
equation
  assert(w_min > 0, "The speed w_min must be positive");
  assert(G >= 0, "The leakage G must not be negative");
  u_p = min((p_set - p)/droop, 2*Modelica.Constants.pi*(q_ref + G*p)/(V*max(abs(w), w_min)));
  annotation(Documentation(info = "<html><p><code>u = 2 pi (q_ref + G p)/(V |w|)</code>: electronic, by the speed measured; what the pump leaks is made up for where <code>G</code> is given, else the flow falls short by it. The pressure cut-off, the limit of torque, the lag and the rates are those of <code>Law</code>. A hydraulic flow control holds the drop over a metering orifice instead: <code>LoadSensingControl</code>. Valid where speed changes more slowly than the swash plate follows. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001, chapter 9.</p></html>"));
end FlowControl;
