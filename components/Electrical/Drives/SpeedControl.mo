within Electrical.Drives;
partial block SpeedControl "Speed controller: torque command from a speed error"
  Interfaces.RealInput w_ref(unit = "rad/s") "Command of speed";
  Interfaces.RealInput w(unit = "rad/s") "Measured speed";
  Interfaces.RealOutput T(unit = "N.m", start = 0) "Command of torque";
  parameter Real K_p(unit = "N.m.s/rad", min = 0) = 0.0791 "Gain";
  parameter Real K_i(unit = "N.m/rad", min = 0) = 8.69 "Integral gain";
  parameter SI.Torque T_max(min = 0) = 9.54 "Greatest torque";
  annotation(Documentation(info = "<html><p>Common ports of the speed controllers.</p></html>"));
end SpeedControl;
