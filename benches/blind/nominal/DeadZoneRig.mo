model DeadZoneRig "The dead-zone rig with a recorded command of speed"
  extends ServoPump.DeadZone(break speed, break connect(speed.y, motor.w_ref));
  Interfaces.RealInput w_ref(unit = "rad/s", nominal = 3) "Command of speed";
  Modelica.Units.SI.Torque T_sh(nominal = 1) "Torque of the pump's shaft";
equation
  connect(w_ref, motor.w_ref);
  T_sh = pump.T_sh;
end DeadZoneRig;
