within Signal;
block DeadZone "Dead zone"
  extends Bases.OneToOne;
  parameter Real uMax = 1 "Upper end";
  parameter Real uMin = -uMax "Lower end";
equation
  assert(uMax >= uMin, "uMax must not lie below uMin");
  y = smooth(0, if u > uMax then u - uMax elseif u < uMin then u - uMin else 0);
  annotation(Documentation(info = "<html><p>Nothing between the ends, beyond them <code>u</code> less the end; the ends are events. Overlap of a spool, backlash of a command, voltage below which a pump does not turn.</p></html>"));
end DeadZone;
