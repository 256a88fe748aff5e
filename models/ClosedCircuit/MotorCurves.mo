within ClosedCircuit;
model MotorCurves "Torque over speed of both motors at one frequency (paper's Fig. 10)"
  parameter SI.Frequency f(min = 1, max = 100) = 27.74 "Frequency of the supply";
  Electrical.Drives.VfInverter inverter "Inverter";
  Signal.Constant frequency(k = f) "Frequency command";
  Signal.Ramp speed(height = 1.1*Modelica.Constants.pi*f, duration = 1) "From standstill to a tenth above the synchronous speed";
  Mechanical.Rotational.Speed shaft "Shaft of both";
  Electrical.Machines.InductionMotorSteady soft(R_r = 0.40) "Motor A";
  Electrical.Machines.InductionMotorSteady stiff(R_r = 0.16) "Motor B";
  Real N(unit = "rev/min", nominal = 1e3) "Speed";
  SI.Torque T_A(nominal = 100) "Torque of motor A";
  SI.Torque T_B(nominal = 100) "Torque of motor B";
equation
  connect(frequency.y, inverter.f_ref);
  connect(inverter.f, soft.f);
  connect(inverter.U, soft.U);
  connect(inverter.f, stiff.f);
  connect(inverter.U, stiff.U);
  connect(speed.y, shaft.w_ref);
  connect(shaft.flange, soft.flange);
  connect(shaft.flange, stiff.flange);
  N = Modelica.Units.Conversions.to_rpm(shaft.w);
  T_A = soft.T_e;
  T_B = stiff.T_e;
  annotation(
    experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6),
    Documentation(info = "<html><p>Time only carries the speed. Near the synchronous speed, 832 r/min, motor A loses 1 rad/s for 14.0 Nm, motor B for 34.9 Nm. At this low frequency motor A has no pull-out torque above standstill: the stator resistance takes too much of the voltage.</p></html>"));
end MotorCurves;
