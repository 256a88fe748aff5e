within Mechanical.Translational;
model ConstantSpeed "Moves a flange with constant speed"
  Interfaces.TranslationalFlange flange "Flange";
  parameter SI.Velocity v_fixed = 0.1 "Speed";
  parameter SI.Position s_start = 0 "Position at time 0";
equation
  flange.s = s_start + v_fixed*time;
  annotation(Documentation(info = "<html><p>The position grows evenly, whatever force that takes.</p></html>"));
end ConstantSpeed;
