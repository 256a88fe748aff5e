//! E016 at 6: "`outer world` finds no `inner world`"
partial model World
  parameter Real g = 9.81;
end World;
model Ball
  outer World world;
  Real v(start = 0, fixed = true);
equation
  der(v) = -world.g;
end Ball;
model M
  Ball ball;
end M;
