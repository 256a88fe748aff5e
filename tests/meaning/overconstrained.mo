//! loop_x(1) = 3
//! root_of_loop(1) = 1
//! b_is_root(1) = 0
//! nearer(1) = 1
//! farther(1) = 0
//! lone_is_root(1) = 1
//! chosen(1) = 1
//! not_chosen(1) = 0
//! ends(1) = 2
//! open(1) = 0
// an angle that every port of a loop carries: the connection that closes the loop says by its constraint, which has no
// equations, that both sides are equal; of two offers the one of the smaller number becomes the root
model M
  type Angle
    extends Real;
    function equalityConstraint
      input Angle a, b;
      output Real residue[0];
    algorithm
      assert(abs(a - b) < 1e-9, "angles differ");
    end equalityConstraint;
  end Angle;
  connector Pin
    Real v;
    flow Real i;
    Angle theta;
  end Pin;
  model Source
    Pin p;
    parameter Real v = 1;
  equation
    p.v = v;
    p.theta = 3;
    Connections.root(p.theta);
  end Source;
  model Part
    Pin a, b;
    Boolean rooted = Connections.rooted(a.theta);
    Boolean root_b = Connections.isRoot(b.theta);
  equation
    a.i + b.i = 0;
    a.v - b.v = a.i;
    a.theta = b.theta;
    Connections.branch(a.theta, b.theta);
  end Part;
  model Offer
    Pin p;
    parameter Integer priority = 0;
    Boolean root = Connections.isRoot(p.theta);
  equation
    p.i = 0;
    if Connections.isRoot(p.theta) then
      p.theta = 7;
    end if;
    Connections.potentialRoot(p.theta, priority);
  end Offer;
  Source s;
  Part one, two, three;
  Offer early(priority = 1), late(priority = 2);
  model Level
    Pin p;
  equation
    p.v = 5;
  end Level;
  Level level;
  Boolean root_of_loop = Connections.isRoot(s.p.theta);
  Boolean b_is_root = one.root_b;
  Boolean nearer = one.rooted;
  Boolean farther = three.rooted;
  Boolean lone_is_root = chosen and not not_chosen;
  Boolean chosen = early.root;
  Boolean not_chosen = late.root;
  Real loop_x = two.b.theta;
  Integer ends = cardinality(one.b);
  Integer open = cardinality(three.b) - 1;
equation
  connect(s.p, one.a);
  connect(one.b, two.a);
  connect(two.b, three.b);
  connect(one.b, three.a);
  connect(early.p, late.p);
  connect(level.p, early.p);
end M;
