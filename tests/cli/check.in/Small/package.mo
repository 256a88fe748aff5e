within;
package Small "Models that run, one that does not, and a part of them"
  model Decay
    Real x(start = 1, fixed = true);
  equation
    der(x) = -x;
  end Decay;
  model Open
    Real x, y;
  equation
    x = time;
  end Open;
  partial model Part
    Real z;
  end Part;
end Small;
