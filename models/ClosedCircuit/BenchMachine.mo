within ClosedCircuit;
model BenchMachine "Pump and motor of the bench, 69.8 ml/r"
  extends Hydraulic.AxialPistonMachine(
    tangentModulus = true,
    p_film0 = 2e6);
end BenchMachine;
