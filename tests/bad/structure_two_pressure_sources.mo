//! E303: "is determined by both `low` and `high`"
model M
  Hydraulic.Tank low;
  Hydraulic.PressureSource high(p = 2e5);
equation
  connect(low.port, high.port);
end M;
