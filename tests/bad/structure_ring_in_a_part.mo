//! model P.M
//! E302 at 5: "nothing fixes the pressure level of {press.pump"
package P
  model Press "a part of the user's own, with library parts inside"
    Hydraulic.Pump pump;
    Hydraulic.Orifice valve(A = 1e-6);
    Mechanical.Rotational.ConstantSpeed motor(w_fixed = 100);
  equation
    connect(motor.flange, pump.flange); connect(pump.port_a, valve.port_a);
    connect(valve.port_b, pump.port_b);
  end Press;
  model M inner Oil.ISOVG46 oil;
    Press press;
  end M;
end P;
