//! E019 at 10: "`k` is final"
model M
  model Gain
    parameter Real k = 1;
  end Gain;
  model Controller
    parameter Real gain = 2;
    Gain g(final k = gain);
  end Controller;
  Controller c(g(k = 5));
end M;
