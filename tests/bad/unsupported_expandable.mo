//! E017 at 6: "expandable connector"
expandable connector Bus
  Real speed;
end Bus;
model M
  Bus bus;
end M;
