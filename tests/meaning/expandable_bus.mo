//! heard.y(1) = 2
//! far.y(1) = 2
//! level.y(1) = 7
// members of a bus come from what is connected to it, and travel to buses that are joined with it
model M
  expandable connector Bus
  end Bus;
  connector In = input Real;
  connector Out = output Real;
  block Sensor
    Out y;
    parameter Real k = 1;
  equation
    y = k;
  end Sensor;
  block Listener
    In u;
    Real y;
  equation
    y = u;
  end Listener;
  model Controller
    Bus bus;
    Sensor own(k = 7);
  equation
    connect(own.y, bus.level);
  end Controller;
  Bus bus;
  Bus other;
  Sensor sensor(k = 2);
  Listener heard, far, level;
  Controller controller;
equation
  connect(sensor.y, bus.speed);
  connect(bus, other);
  connect(bus.speed, heard.u);
  connect(other.speed, far.u);
  connect(controller.bus, bus);
  connect(other.level, level.u);
end M;
