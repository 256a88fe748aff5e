//! E503 at 5: "The second argument of the table must increase"
model M
  parameter Real high = 0.5;
  Signal.Ramp drive(duration = 1);
  Signal.Table2D map(table = [0, 1, high; 0, 1, 2; 1, 3, 4]);
equation
  connect(drive.y, map.u1);
  connect(drive.y, map.u2);
end M;
