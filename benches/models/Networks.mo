package Networks "Networks of any size, to measure how work grows"
  connector Port
    Real p(unit = "Pa", nominal = 1e5);
    flow Real q(unit = "m3/s", nominal = 1e-4);
  end Port;

  model Volume "Oil under pressure"
    Port port;
    parameter Real C(unit = "m3/Pa") = 1e-12;
    Real p(unit = "Pa", start = 1e5, fixed = true, nominal = 1e6);
  equation
    p = port.p;
    C*der(p) = port.q;
  end Volume;

  model Tube "Turbulent flow, laminar near zero"
    Port a;
    Port b;
    parameter Real k = 3e-8 "Flow in m3/s over the root of the pressure in Pa";
    parameter Real dp_lam(unit = "Pa") = 1e4;
    Real dp(unit = "Pa");
  equation
    dp = a.p - b.p;
    a.q = k*dp/(dp^2 + dp_lam^2)^0.25;
    a.q + b.q = 0;
  end Tube;

  model Pump "A flow that swings"
    Port port;
    parameter Real q(unit = "m3/s") = 1e-4;
    parameter Real f(unit = "Hz") = 1;
  equation
    port.q = -q*(1 + 0.5*sin(2*Modelica.Constants.pi*f*time));
  end Pump;

  model Tank
    Port port;
  equation
    port.p = 1e5;
  end Tank;

  model Grid "A square of volumes, each joined to its neighbours by tubes; pumped into one corner, open at the other"
    parameter Integer N = 10;
    Volume v[N, N](C = {{1e-12*(1 + 0.01*mod(7*i + 13*j, 17)) for j in 1:N} for i in 1:N});
    Tube right[N, N - 1];
    Tube down[N - 1, N];
    Pump pump;
    Tube outlet;
    Tank tank;
  equation
    for i in 1:N, j in 1:N - 1 loop
      connect(v[i, j].port, right[i, j].a);
      connect(right[i, j].b, v[i, j + 1].port);
    end for;
    for i in 1:N - 1, j in 1:N loop
      connect(v[i, j].port, down[i, j].a);
      connect(down[i, j].b, v[i + 1, j].port);
    end for;
    connect(pump.port, v[1, 1].port);
    connect(v[N, N].port, outlet.a);
    connect(outlet.b, tank.port);
    annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.03, Tolerance = 1e-6));
  end Grid;

  model Tree "Each volume feeds two, down to the leaves, which are open"
    parameter Integer L = 16 "Leaves, a power of two";
    Volume v[2*L - 1];
    Tube branch[2*L - 2];
    Tube open[L](each k = 1e-8);
    Tank tank;
    Pump pump;
  equation
    connect(pump.port, v[1].port);
    for k in 2:2*L - 1 loop
      connect(v[div(k, 2)].port, branch[k - 1].a);
      connect(branch[k - 1].b, v[k].port);
    end for;
    for k in 1:L loop
      connect(v[L - 1 + k].port, open[k].a);
      connect(open[k].b, tank.port);
    end for;
    annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.03, Tolerance = 1e-6));
  end Tree;

  model Frictions "Masses on springs in a row, each with dry friction to the ground; the first is pushed"
    parameter Integer N = 10;
    Mechanical.Translational.Mass mass[N](each m = 1);
    Mechanical.Translational.SupportFriction friction[N](each f_c = 1, each f_s = 1.5, each v_s = 0.01);
    Mechanical.Translational.SpringDamper spring[N - 1](each c = 1e4, each d = 10);
    Mechanical.Translational.Force push;
  equation
    push.f = 3*N*sin(2*Modelica.Constants.pi*0.5*time);
    connect(push.flange, mass[1].flange_a);
    for k in 1:N loop
      connect(mass[k].flange_a, friction[k].flange_a);
    end for;
    for k in 1:N - 1 loop
      connect(mass[k].flange_b, spring[k].flange_a);
      connect(spring[k].flange_b, mass[k + 1].flange_a);
    end for;
    annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.02, Tolerance = 1e-6));
  end Frictions;
end Networks;
