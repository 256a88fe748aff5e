within Hydraulic.MixedFriction;
partial function Law "What a law of mixed friction takes and gives"
  input Real w_0(unit = "1") "Share of fluid friction that is given for the pair";
  input SI.DynamicViscosity mu "Viscosity in the gap";
  input SI.AngularVelocity w "Speed";
  input SI.Pressure dp "Pressure difference that loads the pair";
  output Real w_f(unit = "1") "Share of fluid friction, 0 to 1";
  annotation(Documentation(info = "<html><p>The rest of the friction is dry. Passive while the share stays from 0 to 1.</p></html>"));
end Law;
