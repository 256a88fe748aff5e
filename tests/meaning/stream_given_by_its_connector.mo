//! model Streams.M
//! silent.seen(0.5) = 3
//! nested.part.seen(0.5) = 7
//! taken(0.5) = 4.75
//! mixed(0.5) = 6
//! through(0.5) = 4
//! second(0.5) = 1
package Streams "The binding of a stream in its connector is what leaves through ports of which a component says nothing"
  connector Port
    Real p;
    flow Real q;
    stream Real h = 3;
  end Port;
  model Sink "Sets the flow that it takes, and says nothing of h"
    parameter Real q = 1;
    Port port;
    Real seen = port.h;
  equation
    port.q = q;
  end Sink;
  model Source
    parameter Real q = -1;
    parameter Real h = 7;
    Port port(h = h);
    Real seen = port.h;
  equation
    port.q = q;
  end Source;
  model Nest "What leaves through its port is what its part sends there"
    Port port;
    Source part;
  equation
    connect(part.port, port);
  end Nest;
  model Pressure
    Port port;
    Real seen = inStream(port.h);
  equation
    port.p = 0;
  end Pressure;
  model Sensor
    Port port;
    Real seen = inStream(port.h);
  equation
    port.q = 0;
  end Sensor;
  model Store "All that comes to its node passes through it"
    parameter Real h = 1;
    Port port(h = h) annotation(__bramah_mixes = true);
    Real inflow = Connections.inflow(port.h);
    Real seen = inStream(port.h);
  equation
    port.p = 0;
  end Store;
  model M
    Sink silent(q = -1);
    Pressure a;
    Nest nested;
    Source quarter(q = -3, h = 4);
    Pressure b;
    Source in_1(q = -1, h = 4);
    Source in_2(q = -2, h = 7);
    Sink out(q = 2);
    Store store;
    Sensor sensor;
    Real taken = b.seen;
    Real mixed = store.seen;
    Real through = store.inflow;
    Real second = sensor.seen;
    Source fourth(q = -1, h = 6);
  equation
    connect(silent.port, a.port);
    connect(nested.port, b.port);
    connect(quarter.port, b.port);
    connect(in_1.port, store.port);
    connect(in_2.port, store.port);
    connect(fourth.port, store.port);
    connect(out.port, store.port);
    connect(sensor.port, store.port);
  end M;
end Streams;
