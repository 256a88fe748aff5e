within ServoPump;
model IdealDrive "Speed held exactly, whatever torque that takes"
  extends Drive;
  Mechanical.Rotational.Speed source "Speed of the shaft";
equation
  connect(w_ref, source.w_ref);
  connect(source.flange, flange);
  T_e = -source.flange.tau;
  w_meas = source.w;
end IdealDrive;
