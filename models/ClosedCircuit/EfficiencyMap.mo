within ClosedCircuit;
model EfficiencyMap "Efficiencies of pump and motor over speed at one pressure, with the share of each kinematic pair in the losses"
  parameter SI.Pressure p(min = 1e5, max = 4e7, nominal = 1e7) = 20e6 "Pressure of the high side above the low side";
  parameter SI.Pressure p_low(nominal = 1e6) = 2e6 "Pressure of the low side";
  parameter Real N_1(unit = "rev/min", min = 10) = 280 "Speed at the start";
  parameter Real N_2(unit = "rev/min", min = 10) = 1500 "Speed at the end";
  inner Oil.ClosedCircuitOil oil "Oil";
  Signal.Ramp speed(offset = Modelica.Units.Conversions.from_rpm(N_1), height = Modelica.Units.Conversions.from_rpm(N_2 - N_1), duration = 1) "Course of the speed";
  Mechanical.Rotational.Speed drive "Shaft of the pump";
  Mechanical.Rotational.Speed brake "Shaft of the motor";
  BenchMachine pump "Pump";
  BenchMachine motor(compression = false) "Hydraulic motor: port B is its high side";
  Hydraulic.PressureSource high(p = p + p_low) "High side";
  Hydraulic.Tank low(p = p_low) "Low side";
  Real N(unit = "rev/min", nominal = 1e3) "Speed";
  Real eta_v(unit = "1") "Volumetric efficiency of the pump";
  Real eta_m(unit = "1") "Hydromechanical efficiency of the pump";
  Real eta_v_m(unit = "1") "Volumetric efficiency of the motor";
  Real eta_m_m(unit = "1") "Hydromechanical efficiency of the motor";
  Real eta(unit = "1") "Efficiency of the pump";
  Real eta_motor(unit = "1") "Efficiency of the motor";
  SI.Pressure dp(nominal = 1e7) "Pressure of the high side above the low side";
  Real share_slipper(unit = "1") "Slippers: part of the pump's power loss, leakage and friction";
  Real share_piston(unit = "1") "Pistons: part of the pump's power loss";
  Real share_plate(unit = "1") "Valve plate: part of the pump's power loss";
  Real share_rest(unit = "1") "Bearings and churning: part of the pump's power loss";
  Real share_compression(unit = "1") "Compression: part of the pump's power loss";
protected
  SI.Power ideal(nominal = 1e4) "Power without losses";
  SI.Power loss(nominal = 1e3) "Power lost in the pump";
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, pump.flange);
  connect(pump.port_a, high.port);
  connect(pump.port_b, low.port);
  connect(speed.y, brake.w_ref);
  connect(brake.flange, motor.flange);
  connect(motor.port_b, high.port);
  connect(motor.port_a, low.port);
  N = Modelica.Units.Conversions.to_rpm(pump.w);
  ideal = pump.V*pump.w/(2*Modelica.Constants.pi)*p;
  eta_v = pump.Q_A*p/ideal;
  eta_m = ideal/(pump.T_sh*pump.w);
  eta_v_m = ideal/(motor.port_b.q*p);
  eta_m_m = -motor.T_sh*motor.w/ideal;
  eta = eta_v*eta_m;
  eta_motor = eta_v_m*eta_m_m;
  dp = high.port.p - low.port.p;
  loss = pump.T_sh*pump.w - pump.Q_A*p;
  share_slipper = (pump.Q_slipper*p + pump.T_slipper*pump.w)/loss;
  share_piston = (pump.Q_piston*p + pump.T_piston*pump.w)/loss;
  share_plate = (pump.Q_plate*p + pump.T_plate*pump.w)/loss;
  share_rest = pump.T_rest*pump.w/loss;
  share_compression = 1 - share_slipper - share_piston - share_plate - share_rest;
  annotation(
    experiment(StartTime = 0, StopTime = 1, Interval = 0.01, Tolerance = 1e-6),
    Documentation(info = "<html><p>Time only carries the speed from <code>N_1</code> to <code>N_2</code>; a sweep over <code>p</code> makes the map. At 20 MPa the volumetric efficiency of the pump rises from 0.85 to 0.96, the hydromechanical one stays at 0.95 to 0.96. Leakage and friction of a pair are counted together; the rest is the oil compressed in the chambers.</p></html>"));
end EfficiencyMap;
