within Hydraulic.SealFriction;
model None "No friction"
  extends Law;
equation
  f = 0;
end None;
