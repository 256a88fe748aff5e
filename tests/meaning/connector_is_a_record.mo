//! model P.M
//! y(1) = -6
//! w(1) = 2
// connectors that are operator records: values, bindings and operators
package P
  operator record C
    Real re, im;
    encapsulated operator '*'
      import P.C;
      function multiply
        input C a, b;
        output C c;
      algorithm
        c := C(a.re*b.re - a.im*b.im, a.re*b.im + a.im*b.re);
      end multiply;
    end '*';
  end C;
  connector In = input C;
  connector Out = output C;
  block Square
    In u;
    Out y;
  equation
    y = u*u;
  end Square;
  model M
    Square s;
    Out w2 = C(2*time, 0);
    Real y = s.y.re;
    Real w = w2.re;
  equation
    s.u = C(1 + 0*time, sqrt(7)*time);
  end M;
end P;
