within CoupledDrives;
model Complete "The drives with dry friction and the pick-up of the bench, which gives the magnitude of the speed"
  parameter Real k_t(unit = "N.m/V", min = 0, max = 10, nominal = 0.1) = 0.0227 "Torque of the motors over their voltage";
  parameter SI.Inertia J_1(min = 1e-9, max = 10, nominal = 1e-3) = 1e-3 "Inertia of the motors";
  parameter SI.Inertia J_2(min = 1e-9, max = 10, nominal = 1e-4) = 3.665e-5 "Inertia of the pulley";
  parameter SI.RotationalDampingConstant d_1(min = 0, max = 10, nominal = 0.01) = 5.34e-3 "Friction and counter-voltage of the motors";
  parameter SI.RotationalDampingConstant d_2(min = 0, max = 10, nominal = 0.01) = 2.356e-4 "Friction of the pulley";
  parameter SI.RotationalSpringConstant c(min = 1e-6, max = 1e4, nominal = 0.01) = 0.01535 "Stiffness of the belt";
  parameter SI.RotationalDampingConstant d(min = 0, max = 10, nominal = 0.01) = 0 "Damping of the belt";
  parameter Real k_y(unit = "V.s/rad", min = 0, nominal = 1) = 1 "Gain of the pick-up";
  parameter SI.Torque tau_c(min = 0, max = 1, nominal = 0.01) = 7.23e-3 "Dry friction of the motors";
  parameter SI.AngularVelocity w_c(min = 1e-4, max = 10, nominal = 0.1) = 0.05 "Speed over which it changes sign";
  parameter SI.Time tau_y(min = 1e-4, max = 1, nominal = 0.01) = 0.0177 "Lag of the pick-up";
  parameter SI.AngularVelocity w_start(min = -100, max = 100, nominal = 1) = 0 "Speed at the start";
  Interfaces.RealInput u(unit = "V", nominal = 1) "Voltage of the motors";
  Interfaces.RealOutput y(unit = "V", nominal = 1) "Speed of the pulley, measured";
  Signal.Gain amplifier(k = k_t) "Torque over voltage";
  Mechanical.Rotational.Torque motor "Torque of the motors";
  Mechanical.Rotational.Inertia rotor(J = J_1, w(start = w_start)) "Motors";
  Mechanical.Rotational.Damper bearing_1(d = d_1) "Friction of the motors";
  Mechanical.Rotational.SmoothBearingFriction dry(tau_c = tau_c, w_c = w_c) "Dry friction of the motors";
  Mechanical.Rotational.SpringDamper belt(c = c, d = d) "Belt";
  Mechanical.Rotational.Inertia pulley(J = J_2, w(start = w_start)) "Pulley";
  Mechanical.Rotational.Damper bearing_2(d = d_2) "Friction of the pulley";
  Mechanical.Rotational.Fixed housing "Housing";
  Mechanical.Rotational.SpeedSensor pickUp "Pick-up of the speed";
  Signal.Gain sensor(k = k_y) "Its gain";
  Signal.FirstOrder lag(T = tau_y) "Its lag";
  Signal.Abs magnitude "Loss of the sign";
equation
  connect(u, amplifier.u);
  connect(amplifier.y, motor.tau);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_a, bearing_1.flange_a);
  connect(bearing_1.flange_b, housing.flange);
  connect(rotor.flange_a, dry.flange_a);
  connect(rotor.flange_b, belt.flange_a);
  connect(belt.flange_b, pulley.flange_a);
  connect(pulley.flange_b, bearing_2.flange_a);
  connect(bearing_2.flange_b, housing.flange);
  connect(pulley.flange_b, pickUp.flange);
  connect(pickUp.w, sensor.u);
  connect(sensor.y, magnitude.u);
  connect(magnitude.y, lag.u);
  connect(lag.y, y);
  annotation(
    experiment(StartTime = 0, StopTime = 9.98, Interval = 0.02, Tolerance = 1e-6),
    Documentation(info = "<html><p>As <code>Nominal</code>, with the dry friction of the motors and a rectifying sensor. Numbers from a fit to the records of 0.5 and 1.5 V.</p></html>"));
end Complete;
