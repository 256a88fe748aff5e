model MedicalAkzo "Radioactive antibodies diffuse into tissue hit by a tumour: a reaction front, by the method of lines"
  parameter Integer N = 200 "Grid points";
  constant Real k = 100 "Rate of the reaction";
  constant Real c = 4 "Stretches the coordinate: zeta = x/(x + c)";
  Real u[N](each start = 0, each fixed = true, each nominal = 1e-4) "Concentration of the antibodies";
  Real v[N](each start = 1, each fixed = true, each nominal = 1e-3) "Concentration of the tissue";
  Real phi "Concentration at the edge, cut off after a while";
protected
  final parameter Real d = 1/N "Distance of the grid points";
  Real left[N], right[N] "Neighbours";
equation
  phi = if time <= 5 then 2 else 0;
  left[1] = phi;
  left[2:N] = u[1:N - 1];
  right[1:N - 1] = u[2:N];
  right[N] = u[N];
  for j in 1:N loop
    der(u[j]) = 2*(j*d - 1)^3/c^2*(right[j] - left[j])/(2*d)
      + (j*d - 1)^4/c^2*(left[j] - 2*u[j] + right[j])/d^2 - k*u[j]*v[j];
    der(v[j]) = -k*u[j]*v[j];
  end for;
  annotation(
    experiment(StartTime = 0, StopTime = 20, Interval = 0.04, Tolerance = 1e-6),
    Documentation(info = "<html><p>Source: R. van der Hout 1994; Test Set for IVP Solvers, problem MEDAKZO, with the published values at 20. The concentrations alternate in the vector of the source: u[j] is number 2j - 1, v[j] is number 2j.</p></html>"));
end MedicalAkzo;
