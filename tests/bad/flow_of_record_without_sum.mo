//! E027 at 13: "its class has no operator '+'"
package P
  operator record C
    Real re, im;
    encapsulated operator function '0'
      import P.C;
      output C c;
    algorithm
      c := C(0, 0);
    end '0';
  end C;
  connector Port
    C e; flow C f;
  end Port;
  model M
    Port a;
  equation
    a.e = C(1, 2);
  end M;
end P;
