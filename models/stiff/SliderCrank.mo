model SliderCrank "Slider crank whose connecting rod bends and stretches (index 3)"
  constant Real pi = 3.1415927 "With the digits of the source";
  constant Real omega = 150 "Speed of the crank";
  constant Real l_1 = 0.15, l_2 = 0.3 "Lengths";
  constant Real m_2 = 0.151104, m_3 = 0.075552 "Masses of rod and slider";
  constant Real J_1 = 0.002727, J_2 = 0.0045339259 "Moments of inertia";
  constant Real E = 2e11 "Modulus of elasticity";
  constant Real b = 0.008, h = 0.008 "Cross section";
  constant Real rho = 7870 "Density";
  Real phi_1(start = 0) "Angle of the crank";
  Real phi_2(start = 0) "Angle of the rod";
  Real x_3(start = 0.45) "Position of the slider";
  Real q[4](start = {0, 0, 1.03339863e-5, 1.69327969e-5}, each fixed = true, nominal = {1e-4, 1e-5, 1e-6, 1e-6},
    each stateSelect = StateSelect.always) "Two modes of bending, middle and end of the stretched rod";
  Real v[4](start = {0.444896112581599, 4.63433931923867e-3, -1.78591076000055e-6, -2.68938671997904e-6},
    each fixed = true, nominal = {0.1, 1e-2, 1e-3, 1e-3}, each stateSelect = StateSelect.always) "Their velocities";
  Real lambda[3](each nominal = 100) "Forces of the constraints";
protected
  constant Real V = b*h*l_2 "Volume of the rod";
  constant Real k = E*b*h/l_2;
  constant Real M[4, 4] = rho*V*[0.5, 0, 0, 0; 0, 0.5, 0, 0; 0, 0, 8, 1; 0, 0, 1, 2] "Masses of the modes";
  constant Real K[4, 4] = k*[pi^4/24*(h/l_2)^2, 0, 0, 0; 0, pi^4*2/3*(h/l_2)^2, 0, 0; 0, 0, 16/3, -8/3; 0, 0, -8/3, 7/3]
    "Stiffnesses";
  constant Real B_3 = 8/pi^3 - 1/pi;
  constant Real B[4, 4] = V*[0, 0, -16/pi^3, B_3; 0, 0, 0, 0.5/pi; 16/pi^3, 0, 0, 0; -B_3, -0.5/pi, 0, 0];
  constant Real c_1[4] = V*{0, 0, 2/3, 1/6};
  constant Real c_2[4] = V*{2/pi, 0, 0, 0};
  constant Real c_12[4] = l_2*V*{0, 0, 1/3, 1/6};
  constant Real c_21[4] = l_2*V*{1/pi, -0.5/pi, 0, 0};
  Real w_1, w_2(nominal = 100) "Angular velocities";
  Real a_1, a_2(nominal = 1e4) "Angular accelerations";
  Real a_q[4] "Accelerations of the modes";
  Real v_3(nominal = 10) "Velocity of the slider";
  Real s, c "Of the angle between crank and rod";
  Real Mq[4], Bv[4], qB[4];
equation
  w_1 = der(phi_1);
  w_2 = der(phi_2);
  v_3 = der(x_3);
  v = der(q);
  a_1 = der(w_1);
  a_2 = der(w_2);
  a_q = der(v);
  s = sin(phi_1 - phi_2);
  c = cos(phi_1 - phi_2);
  Mq = M*q;
  Bv = B*v;
  qB = q*B;

  (J_1 + m_2*l_1^2)*a_1 + (0.5*l_1*l_2*m_2*c + rho*l_1*(s*(c_2*q) + c*(c_1*q)))*a_2 + rho*l_1*((c*c_2 - s*c_1)*a_q)
    = -0.5*l_1*l_2*m_2*w_2^2*s + rho*l_1*w_2^2*(c*(c_2*q) - s*(c_1*q)) - 2*rho*l_1*w_2*(c*(c_1*v) + s*(c_2*v))
    - l_1*cos(phi_1)*lambda[1] - l_1*sin(phi_1)*lambda[2] - lambda[3];
  (0.5*l_1*l_2*m_2*c + rho*l_1*(s*(c_2*q) + c*(c_1*q)))*a_1 + (J_2 + q*Mq + 2*rho*(c_12*q))*a_2 + rho*((c_21 + qB)*a_q)
    = 0.5*l_1*l_2*m_2*w_1^2*s + rho*l_1*w_1^2*(s*(c_1*q) - c*(c_2*q)) - 2*rho*w_2*(c_12*v) - 2*w_2*(v*Mq)
    - rho*(v*Bv) - (l_2 + q[4])*(cos(phi_2)*lambda[1] + sin(phi_2)*lambda[2]);
  m_3*der(v_3) = -lambda[2];
  rho*l_1*(c*c_2 - s*c_1)*a_1 + rho*(c_21 + qB)*a_2 + M*a_q
    = w_2^2*Mq + rho*(w_2^2*c_12 + l_1*w_1^2*(c*c_1 + s*c_2) + 2*w_2*Bv) - K*q
    + {0, 0, 0, cos(phi_2)*lambda[2] - sin(phi_2)*lambda[1]};

  l_1*sin(phi_1) + (l_2 + q[4])*sin(phi_2) = 0;
  x_3 = l_1*cos(phi_1) + (l_2 + q[4])*cos(phi_2);
  phi_1 = omega*time;
  annotation(
    experiment(StartTime = 0, StopTime = 0.1, Interval = 2e-4, Tolerance = 1e-6),
    Documentation(info = "<html><p>In SI units. Source: B. Simeon, Mathematical Modelling of Systems 2, 1996; Test Set for IVP Solvers, problem CRANK, with the published values at 0.1 s (without damping, linear stretching; rod modelled with quadratic elements along and sine waves across).</p></html>"));
end SliderCrank;
