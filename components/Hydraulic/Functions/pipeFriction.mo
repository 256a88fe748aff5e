within Hydraulic.Functions;
function pipeFriction "Pressure drop of a straight smooth pipe: Hagen and Poiseuille to Re 2000, Blasius from Re 4000, blended between"
  input SI.MassFlowRate m_flow "Mass flow";
  input SI.Length L "Length";
  input SI.Diameter d "Inner diameter";
  input SI.Density rho "Density";
  input SI.DynamicViscosity mu "Dynamic viscosity";
  output SI.Pressure dp(nominal = 1e4) "Pressure drop, of the sign of the flow";
protected
  constant Real pi = Modelica.Constants.pi;
  Real Re "Magnitude of the Reynolds number";
  Real u "Place between the two laws";
  Real S "Weight of the turbulent law";
  Real turbulent "Turbulent drop over the laminar one";
algorithm
  Re := 4*abs(m_flow)/(pi*d*mu);
  u := min(max((Re - 2000)/2000, 0), 1);
  S := u*u*(3 - 2*u);
  turbulent := 0.3164/64*(Re + 1)^0.75;
  dp := 128*mu*L/(pi*d^4)*m_flow/rho*(1 - S + S*turbulent);
  annotation(Inline = true, Documentation(info = "<html><p>Blasius to Re 1e5. Source: H. Schlichting, Boundary-Layer Theory, chapter 20.</p></html>"));
end pipeFriction;
