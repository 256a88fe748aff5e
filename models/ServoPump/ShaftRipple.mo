within ServoPump;
model ShaftRipple "Torque ripple in proportion to the load, over the angle of the shaft"
  Interfaces.RotationalFlange flange "Shaft";
  Interfaces.RealInput T_L(unit = "N.m") "Load torque";
  parameter Real a_1(unit = "1", min = 0) = 0.079 "Ripple once per revolution, over the load";
  parameter Real a_14(unit = "1", min = 0) = 0.0125 "Ripple of twice the number of pistons, over the load";
equation
  flange.tau = T_L*(a_1*sin(flange.phi) + a_14*sin(14*flange.phi));
end ShaftRipple;
