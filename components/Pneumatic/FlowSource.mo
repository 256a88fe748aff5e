within Pneumatic;
model FlowSource "Mass flow given by a parameter or a signal"
  parameter Boolean useInput = false "true: the flow comes through m_flow_in" annotation(Evaluate = true);
  parameter SI.MassFlowRate m_flow(min = -10, max = 10, nominal = 1e-3) = 1e-3 "Mass flow out of the port, without signal";
  parameter SI.Temperature T(min = 1, max = 2000, nominal = 300, displayUnit = "degC") = gas.T_0 "Temperature of gas that leaves";
  outer Gas gas "Gas of the circuit";
  PneumaticPort port "Port";
  Interfaces.RealInput m_flow_in(unit = "kg/s") if useInput "Mass flow out of the port";
protected
  Interfaces.RealInput m_flow_used(unit = "kg/s");
equation
  assert(T > 0, "The temperature T must be positive");
  connect(m_flow_in, m_flow_used);
  if not useInput then
    m_flow_used = m_flow;
  end if;
  assert(m_flow_used >= 0 or port.p > 1e-3*gas.p_0, "The source takes " + String(-1e3*m_flow_used) + " g/s out of a node that is empty: its pressure has fallen to a thousandth of that of the surroundings. Nothing, or too little, flows in there");
  port.m_flow = -m_flow_used;
  port.h_outflow = gas.c_p*T;
  annotation(Documentation(info = "<html><p>Gives any pressure that the flow needs; join it to a volume or a restriction. A positive flow leaves the port, with the temperature T. A restriction that is choked cannot pass more than its pressure upstream gives; a source that draws more, or from a volume that is empty, ends with an error.</p></html>"));
end FlowSource;
