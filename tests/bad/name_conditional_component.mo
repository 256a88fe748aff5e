//! E011 at 10: "the conditional component `thermometer` is not there"
model M
  parameter Boolean heated = false;
  Thermometer thermometer if heated;
  Real x;
  model Thermometer
    Real T = 300;
  end Thermometer;
equation
  x = thermometer.T;
end M;
