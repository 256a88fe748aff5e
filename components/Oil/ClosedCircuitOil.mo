within Oil;
model ClosedCircuitOil "Oil of the closed circuit bench (DOI 10.1177/09544054221102779): VG 46, 865 kg/m3, 45 degC"
  extends Oil.Fluid(
    rho_0 = 865,
    T_0 = 318.15,
    redeclare function viscosity = Oil.Viscosity.astmD341(rho = rho_0, nu_1 = 46e-6, nu_2 = 6.8e-6),
    redeclare function thickening = Oil.Thickening.barus(alpha_p = 2e-8));
  annotation(defaultComponentName = "oil", defaultComponentPrefixes = "inner",
    Documentation(info = "<html><p>The paper's tables of the oil are not at hand; class and values are assumed (1 % air, a fifth of it undissolved in the pipe, Barus 2e-8 1/Pa).</p></html>"));
end ClosedCircuitOil;
