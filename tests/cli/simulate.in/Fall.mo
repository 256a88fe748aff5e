model Fall "Ends by itself, or by a broken assertion"
  parameter Real limit = 0.5;
  Real h(start = 1, fixed = true);
equation
  der(h) = -1;
  assert(h > limit, "too low");
  when h < 0.2 then
    terminate("landed");
  end when;
end Fall;
