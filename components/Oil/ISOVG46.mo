within Oil;
model ISOVG46 "Mineral oil of ISO VG 46: 46 mm2/s at 40 degC, 6.8 mm2/s at 100 degC"
  extends Oil.Fluid(
    rho_0 = 875*(1 - 7e-4*(T_0 - 288.15)),
    redeclare function viscosity = Oil.Viscosity.astmD341(rho = rho_0, nu_1 = 46e-6, nu_2 = 6.8e-6));
  annotation(defaultComponentName = "oil", defaultComponentPrefixes = "inner",
    Documentation(info = "<html><p>Viscosity class of ISO 3448 with a viscosity index of about 100, density 875 kg/m3 at 15 degC, expansion 7e-4 1/K.</p></html>"));
end ISOVG46;
