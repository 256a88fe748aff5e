within Signal.Examples;
model FileTableExample "A course over time, a curve and a map, all read from files"
  TimeTable course(fileName = "modelica://Signal/Resources/cycle.csv");
  Table1D curve(fileName = "modelica://Signal/Resources/tables.txt", tableName = "curve");
  AkimaTable smoothCurve(fileName = "modelica://Signal/Resources/tables.txt", tableName = "curve", hold = true);
  Sine source(f = 3, offset = 2);
  Table2D map(fileName = "modelica://Signal/Resources/tables.txt", tableName = "map");
equation
  connect(course.y, curve.u);
  connect(course.y, smoothCurve.u);
  connect(course.y, map.u1);
  connect(source.y, map.u2);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end FileTableExample;
