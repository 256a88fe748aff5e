within Hydraulic;
model TelescopicCylinder "Single-acting telescopic cylinder: the largest stage extends first, the load retracts"
  Interfaces.HydraulicPort port "Chamber";
  Interfaces.TranslationalFlange flange "Rod: the last stage";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Area A[:](each min = 1e-8, each max = 10, each nominal = 1e-3, each displayUnit = "cm2") = {113.1e-4, 63.6e-4, 28.3e-4} "Areas of the stages, the largest first";
  final parameter Integer n = size(A, 1) "Number of stages";
  parameter SI.Length stroke[n](each min = 1e-3, each max = 20, each nominal = 1) = fill(0.5, n) "Stroke of each stage in the one before";
  parameter SI.Mass m[n](each min = 1e-3, each max = 1e6, each nominal = 10) = fill(20, n) "Masses of the moving stages, the largest first";
  parameter SI.Volume V_0(min = 1e-9, max = 10, nominal = 1e-3, displayUnit = "ml") = 1e-3 "Volume at s = 0";
  parameter SI.Force F_c[n](each min = 0, each max = 1e6, each nominal = 100) = fill(100, n) "Dry friction of each stage in the one before";
  parameter SI.TranslationalDampingConstant b[n](each min = 0, each max = 1e8, each nominal = 1e3) = fill(2000, n) "Viscous friction of each stage in the one before";
  parameter SI.Velocity v_s(min = 1e-6, max = 1, nominal = 1e-2) = 2e-3 "Width of the sign of velocity in the dry friction";
  parameter SI.Pressure p_rated(min = 1e4, max = 1e10, nominal = 1e7) = oil.p_max "Pressure that the stops are made for";
  parameter SI.TranslationalSpringConstant k(min = 1e4, max = 1e12, nominal = 1e8) = max(1e8, A[1]*p_rated/d_stop) "Stiffness of the stops of each stage";
  parameter SI.TranslationalDampingConstant d(min = 0, max = 1e10, nominal = 1e5) = 2*zeta*sqrt(k*max(m)) "Damping of the stops";
  parameter SI.Pressure p_ambient(min = 0, max = 1e7, nominal = 1e5) = 101325 "Pressure outside";
  parameter SI.Pressure p_start(min = 1e3, max = 1e8, nominal = 1e6) = 101325 "Pressure at the start";
  replaceable model Air = EntrainedAir.Frozen constrainedby EntrainedAir.Law "What becomes of the air in the oil";
  Chamber chamber(redeclare model Air = Air, A = A[1], side = 1, V_0 = V_0, p_ambient = p_ambient, p_start = p_start) "Chamber; its piston has the area of the first stage and moves as the volume asks";
  Mechanical.Translational.Mass stage[n](m = m) "Stages";
  Mechanical.Translational.ElastoBacklash stops[n](b = stroke, s_rel0 = stroke/2, each c = k, each d = d) "Stops of each stage in the one before";
  Mechanical.Translational.Fixed housing "Housing";
  SI.Position s(nominal = 0.1) "Position of the rod, 0 retracted";
  SI.Velocity v(nominal = 0.1) "Velocity of the rod";
  SI.Position s_rel[n](each nominal = 0.1) "Position of each stage in the one before, 0 retracted";
  SI.Velocity v_rel[n](each nominal = 0.1) "Its velocity";
  SI.Pressure p(nominal = 1e6) "Pressure";
  SI.Force f[n](each nominal = 100) "Friction of each stage in the one before, against positive relative motion";
  SI.Power lossPower(nominal = 10) "Power lost by friction";
protected
  constant Real zeta(unit = "1") = 2.236 "Damping of the stops over the critical one of the heaviest stage";
  parameter SI.Length d_stop = max(min(1e-3*min(stroke), V_0/A[1]/2), 1e-5) "Depth in a stop at p_rated";
  parameter SI.Area ring[n] = {if i < n then A[i] - A[min(i + 1, n)] else A[n] for i in 1:n} "Area on which the oil presses each stage";
  Mechanical.Translational.Position lever "Moves the piston of the chamber as the volume of the stages asks";
  Mechanical.Translational.Force push[n] "Pressure and friction on each stage";
equation
  for i in 1:n loop
    assert(A[i] > 0 and stroke[i] > 0 and m[i] > 0, "The areas, strokes and masses of all stages must be positive");
    assert(F_c[i] >= 0 and b[i] >= 0, "The friction must not be negative");
  end for;
  for i in 2:n loop
    assert(A[i] < A[i - 1], "The areas A must fall from stage to stage: a stage slides in the one before");
  end for;
  connect(port, chamber.port);
  connect(chamber.flange, lever.flange);
  lever.s_ref = ring*stage.s/A[1];
  connect(housing.flange, stops[1].flange_a);
  for i in 1:n loop
    connect(stops[i].flange_b, stage[i].flange_a);
    connect(push[i].flange, stage[i].flange_a);
    s_rel[i] = if i > 1 then stage[i].s - stage[max(i - 1, 1)].s else stage[1].s;
    v_rel[i] = if i > 1 then stage[i].v - stage[max(i - 1, 1)].v else stage[1].v;
    f[i] = F_c[i]*Smooth.sgn(v_rel[i], v_s) + b[i]*v_rel[i];
    push[i].f = ring[i]/A[1]*lever.flange.f - f[i] + (if i < n then f[min(i + 1, n)] else 0);
  end for;
  for i in 1:n - 1 loop
    connect(stage[i].flange_b, stops[i + 1].flange_a);
  end for;
  connect(stage[n].flange_b, flange);
  s = stage[n].s;
  v = stage[n].v;
  p = chamber.p;
  lossPower = f*v_rel;
  annotation(Documentation(info = "<html>
<p>Each stage is a mass between two stops in the one before. The oil presses on the ring <code>A_i - A_(i+1)</code> of stage i and on the area of the last, so that stage i moves in the one before when <code>A_i (p - p_a)</code> exceeds the load with friction: at a slowly rising pressure the largest moves first, at <code>p_a + F/A_1</code>, and each next one when it stands at its stop. Speed rises and pressure steps up from stage to stage; at a constant flow q the rod moves with <code>q/A_i</code>. Under load they retract in the opposite order.</p>
<p>Volume: <code>V = V_0 + sum of (A_i - A_(i+1)) s_i</code>, s_i from the housing; a lever without loss, <code>s = sum of (A_i - A_(i+1)) s_i/A_1</code>, joins the stages to the piston of a <code>Chamber</code>. Friction of each stage: <code>F_c tanh(v_rel/v_s) + b v_rel</code>; a loaded stage creeps within <code>v_s</code>. All start retracted and at rest.</p>
<p>The space between the stages is open to the surroundings (single-acting). Bending is left out. The stops are elastic and damped and never pull; at <code>p_rated</code> on the largest area they give by a thousandth of the shortest stroke or half of what <code>V_0</code> allows, and are never softer than 1e8 N/m; their damping is 2.2 times the critical one of the heaviest stage. Source: the balance of forces on each stage, written here; the values are assumed.</p></html>"));
end TelescopicCylinder;
