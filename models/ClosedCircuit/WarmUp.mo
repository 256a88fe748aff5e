within ClosedCircuit;
model WarmUp "The bench from cold: losses warm the oil, the oil warms housings and reservoir, radiator and walls give the heat to the room"
  extends Bench(
    steady = false,
    oil(thermal = true),
    pump(useHeatPort = true, T_oil_start = T_room),
    hydraulicMotor(useHeatPort = true, T_oil_start = T_room),
    chargePump(T_oil_start = T_room),
    loadPump(T_oil_start = T_room),
    side_A(T_oil_start = T_room),
    side_B(T_oil_start = T_room),
    chargeLine(T_oil_start = T_room),
    flushLine(T_oil_start = T_room),
    loadLine(T_oil_start = T_room),
    cooler(kA = 140, T_ambient = T_room),
    break connect(cooler.oilHeat, oilTemperature.port),
    break oilTemperature,
    break tank);
  parameter SI.Temperature T_room(min = 250, max = 330) = 293.15 "Temperature of the room, and of everything at the start";
  Hydraulic.BaffledReservoir reservoir(A = 0.25, h_start = 0.4, T_oil_start = T_room, useHeatPort = true, kA = 40) "Reservoir, 100 l";
  Hydraulic.Cooler loadCooler(kA = 140, T_ambient = T_room) "Radiator in the return of the load pump, which turns the whole power into heat";
  Hydraulic.Volume loadReturn(V = 5e-4, T_oil_start = T_room) "Line behind the proportional relief valve";
  Thermal.ThermalConductor mount_1(G = 60) "From the oil of the pump to its housing";
  Thermal.HeatCapacitor housing_1(C = 2e4, T_start = T_room) "Housing of the pump, 40 kg";
  Thermal.ThermalConductor air_1(G = 4) "From there to the room";
  Thermal.ThermalConductor mount_2(G = 60) "From the oil of the hydraulic motor to its housing";
  Thermal.HeatCapacitor housing_2(C = 2e4, T_start = T_room) "Housing of the hydraulic motor, 40 kg";
  Thermal.ThermalConductor air_2(G = 4) "From there to the room";
  Thermal.FixedTemperature room(T = T_room) "Room";
  SI.Power P_shafts(nominal = 1e3) "Power that the shafts of all machines give to the oil";
  SI.Power P_room(nominal = 1e3) "Heat that the room takes from radiators, housings and reservoir";
  Real E(unit = "J", nominal = 1e6) "Heat stored in oil and housings, above that at T_room";
equation
  connect(reservoir.port_b, chargePump.port_b);
  connect(chargeRelief.port_b, reservoir.port_a);
  connect(cooler.port_b, reservoir.port_a);
  connect(reservoir.port_b, loadPump.port_b);
  connect(loadRelief.port_b, loadReturn.port);
  connect(loadReturn.port, loadCooler.port_a);
  connect(loadCooler.port_b, reservoir.port_a);
  connect(reservoir.heatPort, room.port);
  connect(pump.heatPort, mount_1.port_a);
  connect(mount_1.port_b, housing_1.port);
  connect(housing_1.port, air_1.port_a);
  connect(air_1.port_b, room.port);
  connect(hydraulicMotor.heatPort, mount_2.port_a);
  connect(mount_2.port_b, housing_2.port);
  connect(housing_2.port, air_2.port_a);
  connect(air_2.port_b, room.port);
  P_shafts = pump.T_sh*pump.w + hydraulicMotor.T_sh*hydraulicMotor.w + chargePump.T_sh*chargePump.w + loadPump.T_sh*loadPump.w;
  P_room = cooler.Q_flow + loadCooler.Q_flow + room.port.Q_flow;
  E = oil.c_p*(reservoir.mass/3*(sum(reservoir.T_oil) - 3*T_room) + sum({
    side_A.mass*(side_A.T_oil - T_room), side_B.mass*(side_B.T_oil - T_room), chargeLine.mass*(chargeLine.T_oil - T_room),
    flushLine.mass*(flushLine.T_oil - T_room), loadLine.mass*(loadLine.T_oil - T_room), loadReturn.mass*(loadReturn.T_oil - T_room),
    oil.rho_0*pump.V_oil*(pump.T_case - T_room), oil.rho_0*hydraulicMotor.V_oil*(hydraulicMotor.T_case - T_room),
    oil.rho_0*chargePump.V_oil*(chargePump.T_case - T_room), oil.rho_0*loadPump.V_oil*(loadPump.T_case - T_room)}))
    + 2e4*(housing_1.port.T - T_room) + 2e4*(housing_2.port.T - T_room);
  annotation(
    experiment(StartTime = 0, StopTime = 10800, Interval = 20, Tolerance = 1e-6),
    Documentation(info = "<html>
<p>The paper holds the temperature; here it comes from the balance of heat: <code>P_shafts = P_room + dE/dt</code>, in watts. All power of the motor ends as heat, most of it in the valve that makes the load, whose return has a radiator of its own.
Sizes of reservoir, radiators and housings are assumed, those of a bench of some 10 kW.</p></html>"));
end WarmUp;
