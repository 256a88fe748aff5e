within Hydraulic.LineFriction;
model Steady "Quasi-steady friction: the drop of a steady flow of the same size"
  extends Law;
equation
  dp = Functions.pipeFriction(m_flow, L, d, rho, mu);
  annotation(Documentation(info = "<html><p>Laminar and turbulent, as <code>Functions.pipeFriction</code>. Flows that change within the time in which viscosity spreads over the cross section, <code>d^2/(23 nu)</code>, are damped too little: at 46 mm2/s and 10 mm above some 2 Hz.</p></html>"));
end Steady;
