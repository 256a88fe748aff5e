//! model P.M
//! stop 2
//! tolerance 1e-4
//! w1(0.34) = 9.32
//! w1(1.26) = 7.48
//! w2(0.34) = 1.02
//! w2(1.26) = 3.78
package P "clutch, J1=1,J2=2/3, torque 2 until locked at t = 2 with w=6"
  model M
    parameter Real J1 = 1, J2 = 2/3, tc = 2;
    Real w1(start = 10, fixed = true), w2(start = 0, fixed = true), tau;
    Boolean locked(start = false, fixed = true);
  equation
    J1*der(w1) = -tau;
    J2*der(w2) = tau;
    if locked then
      der(w1) - der(w2) = 0;
    else
      tau = tc;
    end if;
    when w1 - w2 <= 0 then
      locked = true;
    end when;
  end M;
end P;
