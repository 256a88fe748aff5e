//! E503 at 4: "The abscissae of the table must increase"
model M
  Signal.Ramp drive(duration = 1);
  Signal.Table1D curve(table = [0, 0; 2, 1; 1, 3]);
equation
  connect(drive.y, curve.u);
end M;
