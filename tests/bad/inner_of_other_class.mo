//! E016 at 15: "`outer world` needs a `World`"
model World
  parameter Real g = 9.81;
end World;
model Ground
  parameter Real height = 0;
end Ground;
model Ball
  outer World world;
  Real v(start = 0, fixed = true);
equation
  der(v) = -world.g;
end Ball;
model M
  inner Ground world;
  Ball ball;
end M;
