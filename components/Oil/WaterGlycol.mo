within Oil;
model WaterGlycol "Water glycol HFC 46: 46 mm2/s at 40 degC, viscosity index about 200"
  extends Oil.Fluid(
    rho_0 = 1080*(1 - 6e-4*(T_0 - 288.15)),
    beta_0 = 3.3e9,
    m = 7,
    c_p = 3300,
    gamma = 6e-4,
    redeclare function viscosity = Oil.Viscosity.astmD341(rho = rho_0, nu_1 = 46e-6, nu_2 = 9.6e-6));
  annotation(defaultComponentName = "oil", defaultComponentPrefixes = "inner",
    Documentation(info = "<html><p>Fire-resistant fluid of the class HFC (ISO 12922), a solution of glycols and a thickener with some 40 % of water, of the viscosity class 46 of ISO 3448. The second point, 9.6 mm2/s at 100 degC, is where the line of a viscosity index of 200 leads; use the fluid from -20 to 60 degC, above which its water evaporates. Density 1080 kg/m3 at 15 degC, expansion 6e-4 1/K, heat capacity 3300 J/(kg K), bulk modulus 3.3 GPa with a growth of 7 and the air, 1 %, a fifth of it undissolved, are usual values and assumed: products differ by some 3 % in density and 10 % in heat capacity and modulus. Take those of the data sheet where it matters.</p></html>"));
end WaterGlycol;
