within ServoPump;
model PositionControl "Position controller with feed-forward: speed command from the error of position"
  Interfaces.RealInput x_ref(unit = "m") "Reference of position";
  Interfaces.RealInput x(unit = "m") "Measured position";
  Interfaces.RealOutput w_ref(unit = "rad/s") "Command of speed";
  parameter Real K_x(unit = "1/s", min = 0) = 20 "Gain";
  parameter SI.Time T_f(min = 1e-4) = 0.02 "Time constant of the feed-forward";
  parameter SI.Area A(min = 1e-8) = 50.27e-4 "Area of the piston";
  parameter Real D(unit = "m3/rad", min = 1e-12) = 0.8e-6/(2*Modelica.Constants.pi) "Displacement of the pump";
  parameter SI.AngularVelocity w_max(min = 1) = 314.159 "Greatest speed";
  SI.Position x_f(nominal = 0.1) "Filtered reference";
initial equation
  x_f = x_ref;
equation
  assert(D > 0 and w_max > 0 and T_f > 0, "D, w_max and T_f must be positive");
  T_f*der(x_f) = x_ref - x_f;
  w_ref = min(max(A/D*(K_x*(x_ref - x) + (x_ref - x_f)/T_f), -w_max), w_max);
end PositionControl;
