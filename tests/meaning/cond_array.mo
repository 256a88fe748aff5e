//! model P.M
//! out(0.17) = 0.85
//! out(0.63) = 3.15
package P
  connector In = input Real;
  connector Out = output Real;
  block Gain
    In u;
    Out y;
    parameter Real k = 1;
  equation
    y = k*u;
  end Gain;
  block Src
    Out y = time;
  end Src;
  block Sum
    parameter Integer n = 0;
    In u[n];
    Out y = sum(u);
  end Sum;
  model M
    parameter Boolean b[3] = {true, false, true};
    parameter Integer mode = 2;
    Src s;
    Gain c1(k = 2) if b[1];
    Gain c2(k = 100) if b[2];
    Gain c3(k = 3) if b[3] and mode > 1;
    parameter Integer n = sum(if b[i] then 1 else 0 for i in 1:3);
    Sum sum1(n = 2);
    Real out = sum1.y;
  equation
    connect(s.y, c1.u);
    connect(s.y, c2.u);
    connect(s.y, c3.u);
    connect(c1.y, sum1.u[1]);
    connect(c2.y, sum1.u[1]);
    connect(c3.y, sum1.u[2]);
  end M;
end P;
