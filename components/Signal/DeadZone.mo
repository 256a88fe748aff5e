within Signal;
block DeadZone "Dead zone"
  extends Bases.OneToOne;
  parameter Real uMax = 1 "Upper end";
  parameter Real uMin = -uMax "Lower end";
equation
  assert(uMax >= uMin, "uMax must not lie below uMin");
  y = smooth(0, if u > uMax then u - uMax elseif u < uMin then u - uMin else 0);
end DeadZone;
