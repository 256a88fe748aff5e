model M "Many features in a few lines, to be damaged"
  type Mode = enumeration(rest, forward, backward);
  connector Port
    Real p(unit = "Pa", nominal = 1e5);
    flow Real q(unit = "m3/s", nominal = 1e-4);
  end Port;
  connector RealInput = input Real;
  connector RealOutput = output Real;
  record Law
    Real a = 1;
    Real b[2] = {1, 2};
  end Law;
  function curve
    input Real x;
    input Real c[:];
    output Real y;
  algorithm
    y := 0;
    for i in size(c, 1):-1:1 loop
      y := y*x + c[i];
    end for;
    if y < 0 then
      y := -y;
    end if;
  end curve;
  partial model TwoPort
    Port a;
    Port b;
    Real dp = a.p - b.p;
    Real q = a.q;
  equation
    a.q + b.q = 0;
  end TwoPort;
  model Volume
    Port a;
    parameter Real C = 1e-11;
    Real p(start = 2e5, fixed = true, nominal = 1e5);
  equation
    p = a.p;
    C*der(p) = a.q;
  end Volume;
  replaceable model Restriction = Orifice constrainedby TwoPort;
  model Orifice
    extends TwoPort;
    parameter Real G = 1e-7;
  equation
    a.q = G*dp/(dp*dp + 1e4)^0.25;
  end Orifice;
  model Gain
    RealInput u;
    RealOutput y;
    parameter Real k = 2;
  equation
    y = k*u;
  end Gain;
  model Part
    outer Real level;
    Real x;
  equation
    x = 2*level;
  end Part;
  model Tank
    Port a;
  equation
    a.p = 1e5;
  end Tank;
  parameter Integer n = 3;
  parameter Boolean extra = true;
  parameter Law law(a = 2);
  inner Real level = sin(time);
  Part part if extra;
  Volume v[n](each C = 1e-11, p(start = {3e5, 2e5, 1e5}));
  Restriction r[n];
  Tank tank;
  Gain gain(k = law.b[2]);
  Mode mode(start = Mode.rest, fixed = true);
  discrete Real held(start = 0, fixed = true);
  Integer count(start = 0, fixed = true);
  Real h(start = 1, fixed = true);
  Real w(start = 0, fixed = true);
  Real z(start = 0.5);
equation
  for i in 1:n loop
    connect(v[i].a, r[i].a);
  end for;
  for i in 1:n - 1 loop
    connect(r[i].b, v[i + 1].a);
  end for;
  connect(r[n].b, tank.a);
  gain.u = if time > 0.3 then held else noEvent(max(level, 0));
  der(h) = w;
  der(w) = -9.81;
  z + exp(z) = 2 + 0.1*level + curve(h, law.b);
  when h < 0 then
    reinit(w, -0.7*pre(w));
    count = pre(count) + 1;
  end when;
  when sample(0, 0.1) then
    held = gain.y + curve(time, {1, 2, 3});
  elsewhen initial() then
    held = 0;
  end when;
  mode = if v[1].p > 2.5e5 then Mode.forward elseif pre(mode) == Mode.forward then Mode.rest else Mode.backward;
initial equation
  assert(n > 1, "too few");
algorithm
  assert(h > -1, "fell through " + String(h), AssertionLevel.warning);
  annotation(experiment(StopTime = 1, Interval = 0.05));
end M;
