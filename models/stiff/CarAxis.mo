model CarAxis "Axis of a car on a bumpy road: a spring on each end, positions as constraints (index 3)"
  constant Real M = 10 "Mass of the body";
  constant Real epsilon = 0.01 "Root of the inverse stiffness of the springs";
  constant Real L = 1 "Length of the axis";
  constant Real L_0 = 0.5 "Length of the springs at rest";
  constant Real r = 0.1 "Height of the bumps";
  constant Real omega = 10 "Bumps over time";
  constant Real m = M*epsilon^2/2 "Scaled mass of each end";
  Real x_l(start = 0), y_l(start = L_0, fixed = true, stateSelect = StateSelect.prefer) "Left end";
  Real x_r(start = L), y_r(start = L_0, fixed = true, stateSelect = StateSelect.prefer) "Right end";
  Real v_xl(start = -L_0/L), v_yl(start = 0, fixed = true) "Velocity of the left end";
  Real v_xr(start = -L_0/L), v_yr(start = 0, fixed = true) "Velocity of the right end";
  Real lambda_1(nominal = 1e-3), lambda_2(nominal = 1e-3) "Forces of the constraints";
protected
  Real x_b, y_b "Right wheel";
  Real L_l, L_r "Lengths of the springs";
equation
  y_b = r*sin(omega*time);
  x_b = sqrt(L^2 - y_b^2);
  L_l = sqrt(x_l^2 + y_l^2);
  L_r = sqrt((x_r - x_b)^2 + (y_r - y_b)^2);
  der(x_l) = v_xl;
  der(y_l) = v_yl;
  der(x_r) = v_xr;
  der(y_r) = v_yr;
  m*der(v_xl) = (L_0 - L_l)*x_l/L_l + lambda_1*x_b + 2*lambda_2*(x_l - x_r);
  m*der(v_yl) = (L_0 - L_l)*y_l/L_l + lambda_1*y_b + 2*lambda_2*(y_l - y_r) - m;
  m*der(v_xr) = (L_0 - L_r)*(x_r - x_b)/L_r - 2*lambda_2*(x_l - x_r);
  m*der(v_yr) = (L_0 - L_r)*(y_r - y_b)/L_r - 2*lambda_2*(y_l - y_r) - m;
  0 = x_b*x_l + y_b*y_l;
  0 = (x_l - x_r)^2 + (y_l - y_r)^2 - L^2;
  annotation(
    experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6),
    Documentation(info = "<html><p>Dimensionless. Source: S. Schneider 1990; Test Set for IVP Solvers, problem CARAX, with the published values at 3.</p></html>"));
end CarAxis;
