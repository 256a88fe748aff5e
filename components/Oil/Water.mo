within Oil;
model Water "Water: 992 kg/m3 and 0.65 mPa s at 40 degC"
  extends Oil.Fluid(
    rho_0 = 992.2*(1 - 3.85e-4*(T_0 - 313.15)),
    beta_0 = 2.26e9,
    m = 6,
    mu_ref = 0.653e-3,
    T_mu = 313.15,
    lambda = 0.0188,
    c_p = 4179,
    gamma = 3.85e-4);
  annotation(defaultComponentName = "oil", defaultComponentPrefixes = "inner",
    Documentation(info = "<html><p>Tap or deionised water of water hydraulics. Density 992.2 kg/m3, viscosity 0.653 mPa s, isothermal bulk modulus 2.26 GPa with a growth of 6, heat capacity 4179 J/(kg K) and expansion 3.85e-4 1/K are those of pure water at 40 degC. The exponential law keeps the viscosity to within 6 % from 20 to 60 degC; set <code>mu_ref</code>, <code>T_mu</code> and <code>lambda</code> for other temperatures. Free air as with oil, 1 %, a fifth of it undissolved: assumed.</p>
<p>The laminar transition of orifices and the leakage laws hold for water too; coefficients of pumps and seals measured with oil do not. Source: IAPWS formulations of density and viscosity, as tabulated in the CRC Handbook of Chemistry and Physics.</p></html>"));
end Water;
