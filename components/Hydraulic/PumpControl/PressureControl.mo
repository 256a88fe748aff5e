within Hydraulic.PumpControl;
model PressureControl "Pressure control: as much displacement as holds the pressure"
  extends Law;
equation
  u_p = (p_set - p)/droop;
  annotation(Documentation(info = "<html><p>Full displacement up to <code>p_set - droop</code>, none from <code>p_set</code> on, straight between. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001, chapter 9.</p></html>"));
end PressureControl;
