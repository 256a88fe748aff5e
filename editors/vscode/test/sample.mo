within Plant.Hydraulics;
/* A press,
   and what drives it */
model Press "Pumps; 10 \"bar\" // no comment"
  extends Base(N = 2);
  inner Oil.ISOVG46 oil;
  Hydraulic.Tank tank[3];
  parameter Real k(unit = "1/s") = 1.5e-3 "Gain";
  Real 'a b', x(start = 0);
initial equation
  x = if time > .5 and not true then der(x) else pre(k);
equation
  for i in 1:3 loop
    connect(pump.port, tank[i].port); // joined
  end for;
  annotation(experiment(StopTime = 1, Interval = 1e-3), Icon(graphics = {Line(points = {{0, 1}})}));
end Press;
type Pressure = Real(unit = "Pa");
