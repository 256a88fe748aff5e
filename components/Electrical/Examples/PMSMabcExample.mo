within Electrical.Examples;
model PMSMabcExample "The motor in phases, on sinusoidal voltages turning with it"
  Machines.PMSMabc motor(L_q = 0.5e-3);
  Mechanical.Rotational.ConstantSpeed drive(w_fixed = 50);
  SignalVoltage phase[3];
  Ground ground;
equation
  connect(drive.flange, motor.flange);
  for j in 1:3 loop
    phase[j].v = 32*cos(8*50*time + 1.7 - (j - 1)*2*Modelica.Constants.pi/3);
    connect(phase[j].n, ground.p);
  end for;
  connect(phase[1].p, motor.a);
  connect(phase[2].p, motor.b);
  connect(phase[3].p, motor.c);
  annotation(experiment(StartTime = 0, StopTime = 0.1, Interval = 0.0002, Tolerance = 1e-6));
end PMSMabcExample;
