//! E011 at 11: "`tank.area` is protected"
model Tank
  parameter Real h = 1;
protected
  Real area = 2;
end Tank;
model M
  Tank tank;
  Real x;
equation
  x = tank.area;
end M;
