model TwoBitAdder "Adder for two bits of 39 MOS transistors in ten gates, index 1"
  connector Pin "Terminal"
    Real v "Potential in V";
    flow Real i "Current";
  end Pin;

  model Transistor "Field-effect transistor with resistances and capacitances between its inner and outer nodes"
    parameter Real V_0 = 0.2 "Threshold without bulk voltage";
    parameter Real gamma = 0.035 "Influence of the bulk";
    parameter Real phi = 1.01 "Surface potential";
    parameter Real beta(min = 0) = 8.74 "Conductance";
    parameter Real s_start = 0 "Potential of the source at the start";
    parameter Real d_start = 0 "Potential of the drain at the start";
    parameter Real g_start = 0 "Potential of the gate at the start";
    constant Real R = 8e-4 "Resistance of source and of drain";
    constant Real R_b = 2e-3 "Resistance of the bulk";
    constant Real C_g = 0.6 "Capacitance of the gate, each side";
    constant Real C_b = 0.24 "Capacitance of a bulk junction without voltage";
    constant Real phi_b = 0.87 "Potential of the junctions";
    constant Real delta = 0.02 "Channel length modulation";
    constant Real I_s = 5e-11 "Reverse current of a junction";
    constant Real V_T = 25.85 "Voltage in the exponent of a junction";
    constant Real V_bb = -2.5 "Supply of the bulk";
    Pin g "Gate";
    Pin s "Source";
    Pin d "Drain";
    Real u_gs(start = s_start - g_start, fixed = true) "Inner source against gate";
    Real u_gd(start = d_start - g_start, fixed = true) "Inner drain against gate";
    Real u_bs(start = V_bb - s_start, fixed = true) "Bulk against source";
    Real u_bd(start = V_bb - d_start, fixed = true) "Bulk against drain";
    Real v_s(start = s_start) "Inner source";
    Real v_d(start = d_start) "Inner drain";
    Real j "Current of the channel from drain to source";
  protected
    Real u_ds = v_d - v_s;
    Real w_s = g.v - v_s - V_0 - gamma*(sqrt(phi - u_bs) - sqrt(phi)) "Gate above threshold, source side";
    Real w_d = g.v - v_d - V_0 - gamma*(sqrt(phi - u_bd) - sqrt(phi)) "Gate above threshold, drain side";
    Real i_s "Current from bulk to source";
    Real i_d "Current from bulk to drain";
    function slope "Derivative of a junction's charge by its voltage"
      input Real u;
      output Real C;
    algorithm
      C := if u <= 0 then C_b*(1 - u/(2*phi_b))/(1 - u/phi_b)^1.5 else C_b*(1 + u/phi_b);
    end slope;
  equation
    u_gs = v_s - g.v;
    u_gd = v_d - g.v;
    j = smooth(1, noEvent(
      if u_ds >= 0 then
      (if w_s <= 0 then 0 elseif w_s <= u_ds then beta*w_s^2*(1 + delta*u_ds) else beta*u_ds*(2*w_s - u_ds)*(1 + delta*u_ds))
      else
      (if w_d <= 0 then 0 elseif w_d <= -u_ds then -beta*w_d^2*(1 - delta*u_ds) else beta*u_ds*(2*w_d + u_ds)*(1 - delta*u_ds))));
    C_g*der(u_gs) = j - (v_s - s.v)/R;
    C_g*der(u_gd) = -j - (v_d - d.v)/R;
    i_s = (V_bb - u_bs - s.v)/R_b;
    i_d = (V_bb - u_bd - d.v)/R_b;
    slope(u_bs)*der(u_bs) = i_s - noEvent(if u_bs <= 0 then I_s*(exp(u_bs/V_T) - 1) else 0);
    slope(u_bd)*der(u_bd) = i_d - noEvent(if u_bd <= 0 then I_s*(exp(u_bd/V_T) - 1) else 0);
    s.i = (s.v - v_s)/R - i_s;
    d.i = (d.v - v_d)/R - i_d;
    g.i = -C_g*(der(u_gs) + der(u_gd));
  end Transistor;

  model Potential "Fixed potential"
    parameter Real v = 0;
    Pin p;
  equation
    p.v = v;
  end Potential;

  model Load "Capacitance against ground"
    parameter Real v_start = 0;
    constant Real C = 2 "Capacitance";
    Real v(start = v_start, fixed = true) "Voltage in V";
    Pin p;
  equation
    v = p.v;
    C*der(v) = p.i;
  end Load;

  model Gate "Depletion transistor that lifts the output"
    parameter Real y_start = 5 "Output at the start";
    constant Real V_dd = 5 "Supply";
    Transistor load(V_0 = -2.43, gamma = 0.2, phi = 1.28, beta = 2.675, s_start = y_start, g_start = y_start, d_start = V_dd);
    Pin y "Output";
    Potential supply(v = V_dd);
    Potential ground;
  equation
    connect(load.d, supply.p);
    connect(load.s, y);
    connect(load.g, y);
  end Gate;

  model Nor "not (a or b)"
    extends Gate;
    parameter Real a_start = 0;
    Pin a;
    Pin b;
    Transistor t_a(d_start = y_start, g_start = a_start);
    Transistor t_b(d_start = y_start);
  equation
    connect(a, t_a.g);
    connect(b, t_b.g);
    connect(t_a.d, y);
    connect(t_b.d, y);
    connect(t_a.s, ground.p);
    connect(t_b.s, ground.p);
  end Nor;

  model AndNor "not (a or (b and c))"
    extends Gate(y_start = 0.204);
    parameter Real b_start = 0;
    parameter Real c_start = 0;
    parameter Real m_start = -0.026 "Potential between the transistors of b and c at the start";
    Pin a;
    Pin b;
    Pin c;
    Transistor t_a(d_start = y_start, g_start = 5);
    Transistor t_b(beta = 17.48, d_start = y_start, s_start = m_start, g_start = b_start);
    Transistor t_c(beta = 17.48, d_start = m_start, g_start = c_start);
  equation
    connect(a, t_a.g);
    connect(b, t_b.g);
    connect(c, t_c.g);
    connect(t_a.d, y);
    connect(t_b.d, y);
    connect(t_b.s, t_c.d);
    connect(t_a.s, ground.p);
    connect(t_c.s, ground.p);
  end AndNor;

  model Nand "not (a and b)"
    extends Gate;
    parameter Real m_start = -0.026 "Potential between the transistors at the start";
    Pin a;
    Pin b;
    Transistor t_a(beta = 17.48, d_start = y_start, s_start = m_start, g_start = 0.204);
    Transistor t_b(beta = 17.48, d_start = m_start, g_start = 0.204);
  equation
    connect(a, t_a.g);
    connect(b, t_b.g);
    connect(t_a.d, y);
    connect(t_a.s, t_b.d);
    connect(t_b.s, ground.p);
  end Nand;

  model OrNand "not (a and (b or c))"
    extends Gate;
    parameter Real m_start = 4.745 "Potential between the transistors at the start";
    Pin a;
    Pin b;
    Pin c;
    Transistor t_a(beta = 17.48, d_start = y_start, s_start = m_start, g_start = 5);
    Transistor t_b(beta = 17.48, d_start = m_start, g_start = 0.204);
    Transistor t_c(beta = 17.48, d_start = m_start, g_start = 0.204);
  equation
    connect(a, t_a.g);
    connect(b, t_b.g);
    connect(c, t_c.g);
    connect(t_a.d, y);
    connect(t_a.s, t_b.d);
    connect(t_a.s, t_c.d);
    connect(t_b.s, ground.p);
    connect(t_c.s, ground.p);
  end OrNand;

  model Pulse "Rises in 5, stays high, falls in 5, periodically"
    parameter Real delay = 0;
    parameter Real high = 5 "How long it stays high";
    parameter Real period = 20;
    Pin y;
  protected
    Real phase = time - period*floor(time/period);
  equation
    y.v = if phase <= delay then 0 elseif phase <= delay + 5 then phase - delay
      elseif phase <= delay + 5 + high then 5
      elseif phase <= delay + 10 + high then delay + 10 + high - phase else 0;
  end Pulse;

  Pulse a_0 "Lower bit of the first number";
  Pulse b_0(delay = 10, high = 15, period = 40);
  Pulse a_1(delay = 30, high = 35, period = 80);
  Pulse b_1(delay = 70, high = 75, period = 160);
  Pulse carry(delay = 150, high = 155, period = 320) "Carry from below, inverted";
  Nor nor_1;
  AndNor andNor_1(m_start = -0.228);
  Nor nor_2(a_start = 0.204);
  AndNor andNor_2(c_start = 0.204);
  AndNor andNor_3(c_start = 0.204);
  Nor nor_3;
  AndNor andNor_4(m_start = -0.228);
  Nand nand;
  OrNand orNand;
  AndNor andNor_5(b_start = 5, c_start = 0.204, m_start = 0.204);
  Transistor t_1(beta = 26.22, d_start = 0.204, s_start = -0.026, g_start = 0.204);
  Transistor t_2(beta = 26.22, d_start = -0.026, s_start = -0.026, g_start = 0.204);
  Transistor t_3(beta = 26.22, d_start = -0.026);
  Potential ground;
  Load s_0(v_start = 0.204) "Lower bit of the sum, inverted";
  Load s_1(v_start = 5) "Upper bit of the sum, inverted";
  Load c(v_start = 0.204) "Carry";
equation
  connect(a_0.y, nor_1.a);
  connect(b_0.y, nor_1.b);
  connect(nor_1.y, andNor_1.a);
  connect(b_0.y, andNor_1.b);
  connect(a_0.y, andNor_1.c);
  connect(andNor_1.y, nor_2.a);
  connect(carry.y, nor_2.b);
  connect(nor_2.y, andNor_2.a);
  connect(carry.y, andNor_2.b);
  connect(andNor_1.y, andNor_2.c);
  connect(nor_1.y, andNor_3.a);
  connect(carry.y, andNor_3.b);
  connect(andNor_1.y, andNor_3.c);
  connect(a_1.y, nor_3.a);
  connect(b_1.y, nor_3.b);
  connect(nor_3.y, andNor_4.a);
  connect(b_1.y, andNor_4.b);
  connect(a_1.y, andNor_4.c);
  connect(andNor_3.y, nand.a);
  connect(andNor_4.y, nand.b);
  connect(nand.y, orNand.a);
  connect(andNor_3.y, orNand.b);
  connect(andNor_4.y, orNand.c);
  connect(nor_3.y, andNor_5.a);
  connect(nor_1.y, andNor_5.b);
  connect(andNor_4.y, andNor_5.c);
  connect(andNor_5.y, t_1.d);
  connect(andNor_4.y, t_1.g);
  connect(t_1.s, t_2.d);
  connect(andNor_1.y, t_2.g);
  connect(t_2.s, t_3.d);
  connect(carry.y, t_3.g);
  connect(t_3.s, ground.p);
  connect(andNor_2.y, s_0.p);
  connect(orNand.y, s_1.p);
  connect(andNor_5.y, c.p);
  annotation(
    experiment(StartTime = 0, StopTime = 320, Interval = 0.5, Tolerance = 1e-6),
    Documentation(info = "<html><p>Adds two numbers of two bits and a carry. The carry from below comes inverted and the bits of the sum go inverted; high is 5 V, low 0.2 V. Each of the 39 transistors has four inner nodes behind resistances, with a capacitance each; the inputs are trapezoidal pulses with 63 bends. Time in ns, currents in a unit that makes the capacitance of a gate 0.6.
Published at 320: s_0 0.2040419147, s_1 4.997238456, c 0.2038985906, found with a tolerance of 1e-5. Source: M. Guenther, P. Rentrop 1996; Test Set for IVP Solvers, problem TBA, there with charges and potentials as 350 unknowns. Here the capacitor voltages are states, which start at the potentials of the outer nodes; two slips in the charges of the original (bulk junctions at the supply and in the NOR gates) are not repeated: s_1 differs by 4e-6, the others by less than 2e-8.</p></html>"));
end TwoBitAdder;
