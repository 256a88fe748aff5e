//! model P.M
//! a.p(0.17) = 3.4
//! a.p(0.63) = 12.6
//! b.a.p(0.17) = 5.1
//! b.a.p(0.63) = 18.9
package P
  record Fluid
    parameter Real rho = 10;
    parameter Real K[2] = {1, 2};
  end Fluid;
  model Sys
    parameter Fluid fluid;
    parameter Real g = 2;
    function press
      input Real h;
      output Real p;
    algorithm
      p := 5*h;
    end press;
  end Sys;
  model A
    outer Sys sys;
    Real p = sys.fluid.rho*sys.g*time*(if sys.fluid.K[end] > 1 then 1 else 0);
  end A;
  model B
    inner Sys sys(fluid = Fluid(rho = 15));
    A a;
  end B;
  model M
    inner Sys sys;
    A a;
    B b;
  end M;
end P;
