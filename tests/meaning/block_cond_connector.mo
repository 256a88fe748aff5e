//! model P.M
//! a.y(0.89) = 10
//! b.y(0.17) = 0.51
//! b.y(0.63) = 1.89
package P
  block G
    parameter Boolean useInput = false;
    parameter Real k0 = 5;
    parameter Real g = 2;
    input Real u if useInput;
    output Real y;
  protected
    Conn c;
    block K
      parameter Real k;
      output Real y = k;
    end K;
    K kk(k = k0) if not useInput;
  equation
    connect(u, c.u);
    connect(kk.y, c.u);
    y = g*c.y;
  end G;
  block Conn
    input Real u;
    output Real y = u;
  end Conn;
  block T
    output Real y = time;
  end T;
  model M
    G a;
    G b(useInput = true, g = 3);
    T t;
  equation
    connect(t.y, b.u);
  end M;
end P;
