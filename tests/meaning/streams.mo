//! h_mix(1) = 3.5
//! h_back(1) = 2
//! through(1) = 3.5
// a node of three: 1 kg/s with 2 and 3 kg/s with 4 flow into a tank, whose own content would flow back as 9
model M
  connector Port
    Real p;
    flow Real m_flow;
    stream Real h;
  end Port;
  model Source
    parameter Real m = 1, h = 1;
    Port port;
  equation
    port.m_flow = -m;
    port.h = h;
  end Source;
  model Tank
    Port port;
    Real arriving;
    Real carried;
  equation
    port.p = 1e5;
    port.h = 9;
    arriving = inStream(port.h);
    carried = actualStream(port.h);
  end Tank;
  model Pipe "two ports and a node inside"
    Port a;
    Port b;
  equation
    connect(a, b);
  end Pipe;
  Source one(m = 1, h = 2);
  Source two(m = 3, h = 4);
  Tank tank;
  Pipe pipe;
  Real h_mix = tank.arriving;
  Real through = tank.carried;
  Real h_back;
  model Pair
    Source s(m = 1, h = 2);
    Tank t;
  equation
    connect(s.port, t.port);
  end Pair;
  Pair pair;
equation
  h_back = pair.t.arriving;
  connect(one.port, pipe.a);
  connect(two.port, pipe.a);
  connect(pipe.b, tank.port);
end M;
