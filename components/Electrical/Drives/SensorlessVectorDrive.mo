within Electrical.Drives;
model SensorlessVectorDrive "Induction motor under sensorless flux vector control, reduced: torque lag, estimated speed with lag, PI controller"
  Interfaces.RealInput w_ref(unit = "rad/s") "Command of speed";
  Interfaces.RotationalFlange flange "Shaft";
  parameter Real K_p(unit = "N.m.s/rad", min = 1e-9) = 20 "Gain";
  parameter Real K_i(unit = "N.m/rad", min = 0) = 150 "Integral gain";
  parameter SI.Time tau_T(min = 1e-6) = 10e-3 "Time constant of the torque";
  parameter SI.Time tau_w(min = 1e-6) = 50e-3 "Time constant of the estimated speed";
  parameter SI.Torque T_max(min = 1e-6) = 300 "Greatest torque";
  parameter SI.AngularVelocity w_start = 0 "Estimated speed at the start";
  parameter Boolean steady = false "true: torque, controller and estimate stand at the start" annotation(Evaluate = true);
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.AngularVelocity w_est(start = w_start, fixed = not steady, nominal = 100) "Estimated speed";
  SI.AngularVelocity e(nominal = 1) "Control error";
  SI.Torque x(start = 0, fixed = not steady, nominal = 100) "Integral part";
  SI.Torque T_e(start = 0, fixed = not steady, nominal = 100) "Torque of the motor";
initial equation
  if steady then
    {der(w_est), der(x), der(T_e)} = zeros(3);
  end if;
equation
  assert(K_p > 0 and tau_T > 0 and tau_w > 0 and T_max > 0, "K_p, time constants and T_max must be positive");
  w = der(flange.phi);
  e = w_ref - w_est;
  tau_w*der(w_est) = w - w_est;
  tau_T*der(T_e) = min(max(K_p*e + x, -T_max), T_max) - T_e;
  der(x) = K_i*e + K_i/K_p*(min(max(K_p*e + x, -T_max), T_max) - (K_p*e + x));
  flange.tau = -T_e;
  annotation(Documentation(info = "<html><p><code>tau_T dT/dt = sat(K_p e + x) - T</code>, <code>tau_w dw_est/dt = w - w_est</code>: the loop holds the speed without droop, and the lag of the estimate is what makes it oscillate. With flux and slip: <code>FluxVectorDrive</code>, with the same ports. Form and values: reduced model for DOI 10.1177/09544054221102779, values assumed.</p></html>"));
end SensorlessVectorDrive;
