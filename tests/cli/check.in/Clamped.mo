model Clamped "A load joined to the frame"
  parameter Modelica.Units.SI.Force f = 10;
  Mechanical.Translational.Mass load(m = 100);
  Mechanical.Translational.Fixed frame;
  Mechanical.Translational.Force push(f = f);
equation
  connect(push.flange, load.flange_a);
  connect(load.flange_b, frame.flange);
end Clamped;
