within Hydraulic.SealFriction;
model None "No friction"
  extends Law;
equation
  f = 0;
  annotation(Documentation(info = "<html><p>Without friction.</p></html>"));
end None;
