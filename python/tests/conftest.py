"""Models that several tests use, with answers in closed form."""

import math

import pytest

import bramah as br

TANK = """
model Tank "A tank that empties"
  input Real u(start = 1, unit = "m/s") "inflow";
  parameter Real k(unit = "1/s", min = 0, max = 100) = 2 "rate";
  parameter Real p(unit = "Pa", displayUnit = "bar") = 1e5;
  parameter Real a[2](each unit = "Pa") = {1, 2};
  parameter Boolean on = true;
  parameter Integer n = 2;
  Real h(start = 1, fixed = true, unit = "m") "level";
  Boolean high;
  output Real y(unit = "m");
equation
  der(h) = u - k*h;
  high = h > 0.7;
  y = if on then n*h else 0;
end Tank;"""

DECAY = """
model Decay
  parameter Real k = 2;
  Real x(start = 1, fixed = true);
equation
  der(x) = -k*x;
end Decay;"""

# stiff enough to take a while, chosen by its stop time
LONG = """
model Long
  parameter Real mu = 5;
  Real x(start = 2, fixed = true);
  Real y(start = 0, fixed = true);
equation
  der(x) = y;
  der(y) = mu*(1 - x*x)*y - x;
end Long;"""

SLIDE = """
package Slide
  model Nominal "A mass on a spring"
    input Real u(unit = "N");
    Mechanical.Translational.Mass mass(m = 10, s(start = 0, fixed = true), v(start = 0, fixed = true));
    Mechanical.Translational.SpringDamper spring(c = 400, d = 30);
    Mechanical.Translational.Fixed wall;
    Mechanical.Translational.Force push;
  equation
    push.f = u;
    connect(wall.flange, spring.flange_a);
    connect(spring.flange_b, mass.flange_a);
    connect(push.flange, mass.flange_b);
  end Nominal;
  model Rig "The same with dry friction"
    extends Nominal;
    Mechanical.Translational.SmoothSupportFriction rub(f_c = 4);
  equation
    connect(rub.flange_a, mass.flange_b);
  end Rig;
end Slide;"""

PRESS = """
model Press "A pump fills a volume, a relief valve limits its pressure"
  Hydraulic.Tank tank;
  Hydraulic.FlowSource pump(q = 1e-4);
  Hydraulic.Volume volume(V = 0.5e-3);
  Hydraulic.ReliefValve relief(p_set = 150e5);
equation
  connect(pump.port, volume.port);
  connect(volume.port, relief.port_a);
  connect(relief.port_b, tank.port);
  annotation(experiment(StopTime = 1));
end Press;"""


def level(t, k=2.0, u=1.0, start=1.0):
    """The tank's level: h' = u - k h."""
    return u / k + (start - u / k) * math.exp(-k * t)


@pytest.fixture(scope="session")
def tank():
    return br.load(TANK)


@pytest.fixture(scope="session")
def decay():
    return br.load(DECAY)


@pytest.fixture(scope="session")
def press():
    return br.load(PRESS)


@pytest.fixture(scope="session")
def long():
    return br.load(LONG)
