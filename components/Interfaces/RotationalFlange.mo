within Interfaces;
connector RotationalFlange "Flange of a shaft"
  SI.Angle phi "Absolute angle of the flange";
  flow SI.Torque tau "Torque acting on the component through the flange";
end RotationalFlange;
