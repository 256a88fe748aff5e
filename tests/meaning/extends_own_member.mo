//! model P.M
//! x(0.5) = 1.5
//! y(0) = 0.8414709848078965
//! z(0) = 2
package P
  extends P.Icons.Package;
  package Icons
    extends Icons.Package;
    partial package Package
      constant Real c = 2;
    end Package;
    partial model Thing
      Real x = 3*time;
    end Thing;
  end Icons;
  package Math
    extends P.Icons.Package;
    function sin
      input Real u;
      output Real y;
    algorithm
      y := .sin(u);
    end sin;
  end Math;
  model M
    extends P.Icons.Thing annotation(IconMap(primitivesVisible = false), __Vendor_flag, __Vendor(a, b = 3));
    Real y = P.Math.sin(time + 1);
    Real z = P.c;
    annotation(__Vendor_flag, experiment(StopTime = 1));
  end M;
end P;
