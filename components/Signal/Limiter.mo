within Signal;
block Limiter "Limits of a signal"
  extends Bases.OneToOne;
  parameter Real uMax = 1 "Upper limit";
  parameter Real uMin = -uMax "Lower limit";
equation
  assert(uMax >= uMin, "uMax must not lie below uMin");
  y = smooth(0, if u > uMax then uMax elseif u < uMin then uMin else u);
  annotation(Documentation(info = "<html><p>Follows the input within the limits; reaching them is an event.</p></html>"));
end Limiter;
