within Hydraulic.PumpControl;
model PowerControl "Power control: pressure times flow below a limit, a hyperbola; below a pressure cut-off"
  extends PressureControl(final T_max = P_max/w_nom);
  parameter SI.Power P_max(min = 1, max = 1e7, nominal = 1e4) = 1e4 "Limit of pressure above p_ref times ideal flow at w_nom";
  parameter SI.AngularVelocity w_nom(min = 1, max = 1e3, nominal = 100) = 157 "Speed at which the limit holds";
equation
  assert(P_max > 0 and w_nom > 0, "P_max and w_nom must be positive");
  annotation(Documentation(info = "<html><p><code>u V w_nom/(2 pi) p = P_max</code> where the displacement is not already less: full displacement up to <code>P_max</code> over the full flow, then the hyperbola, then the pressure cut-off from <code>p_set - droop</code> to <code>p_set</code>. It is the limit of torque of <code>Law</code>, <code>T_max = P_max/w_nom</code>; at another speed the power is in proportion to it, as of a mechanical power control. An ideal hyperbola: controls with two springs follow it by two straight lines. The losses of the pump come on top of <code>P_max</code>. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001, chapter 9.</p></html>"));
end PowerControl;
