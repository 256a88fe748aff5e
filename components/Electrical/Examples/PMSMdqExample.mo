within Electrical.Examples;
model PMSMdqExample "The same in rotor axes"
  Machines.PMSM motor(L_q = 0.5e-3);
  Mechanical.Rotational.ConstantSpeed drive(w_fixed = 50);
equation
  connect(drive.flange, motor.flange);
  motor.u_d = 32*cos(1.7);
  motor.u_q = 32*sin(1.7);
  annotation(experiment(StartTime = 0, StopTime = 0.1, Interval = 0.0002, Tolerance = 1e-6));
end PMSMdqExample;
