within ServoPump;
model Throttle "Throttle opened by hand until the pressure before it is reached"
  extends Hydraulic.Bases.TwoPort;
  parameter SI.Pressure p_set(min = 1e4, max = 3e7, nominal = 1e7) = 1e7 "Pressure drop wanted";
  parameter SI.VolumeFlowRate q_min(min = 1e-12) = 1e-8 "Least flow that the throttle passes at p_set";
  parameter SI.Time tau(min = 1e-3) = 0.3 "Time in which it is turned";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter SI.Time startTime = 1.5 "Left alone before";
  parameter SI.Area A_start(min = 1e-12, nominal = 1e-7) = 1e-8 "Cross section at the start";
  SI.Area A(start = A_start, fixed = true, nominal = 1e-7) "Cross section";
protected
  SI.Area A_want(nominal = 1e-7) "Cross section that passes the present flow at p_set";
equation
  assert(p_set > 0, "The pressure p_set must be positive");
  A_want = max(q, q_min)/(C_d*sqrt(2*p_set/rho));
  tau*der(A) = if time < startTime then 0 else A_want - A;
  q = Hydraulic.Functions.orificeFlow(dp, A, C_d, rho, mu_in);
  annotation(Documentation(info = "<html><p>On the bench the load is set by turning a throttle; here its cross section follows the one that passes the present flow at the pressure wanted.</p></html>"));
end Throttle;
