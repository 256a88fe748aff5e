//! E105 at 6: "different size"
model M
  Signal.Constant source[3](k = {1, 2, 3});
  Signal.Gain gain[2];
equation
  connect(source.y, gain.u);
end M;
