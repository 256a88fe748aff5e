//! E216 at 6: "4"
model M
  Signal.Constant source[3](k = {1, 2, 3});
  Signal.Gain gain;
equation
  connect(source[4].y, gain.u);
end M;
