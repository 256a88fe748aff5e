//! E010 at 3: "`Modelica` has no class `Mechanics`"
model M
  Modelica.Mechanics.Rotational.Components.Inertia inertia;
end M;
