model PumpAxis "The pump-controlled cylinder with recorded reference and load force"
  // calmer than the bench's loop, whose pilot-operated valves hunt when the load is small
  extends ServoPump.System(
    K_x = 6,
    break reference, break connect(reference.y, control.x_ref),
    break loadForce, break connect(loadForce.y, force.f));
  Interfaces.RealInput r(unit = "m", nominal = 0.1) "Reference of position";
  Interfaces.RealInput F(unit = "N", nominal = 1e4) "Force on the load";
equation
  connect(r, control.x_ref);
  connect(F, force.f);
end PumpAxis;
