within Oil;
model ServoPumpOil "Oil of the servo pump bench of Zhang et al., Processes 2021, 9, 814"
  extends Oil.Fluid(
    rho_0 = 837,
    T_0 = 308.15,
    mu_ref = 13.8e-6*837,
    T_mu = 323.15,
    lambda = 0.0357);
  annotation(
    defaultComponentName = "oil",
    defaultComponentPrefixes = "inner",
    Documentation(info = "<html>
<p>837 kg/m3, 13.8 mm2/s at 50 degC, 33.5 to 36.5 degC in the experiments (table 1 of the paper). The paper prints the viscosity as dynamic with the unit of a
kinematic one, and the temperature coefficient as 1.5; read as the exponent of <code>nu = nu_50 (50/theta)^n</code> it equals 0.0357 1/K between 35 and 50 degC, whereas 1.5 1/K would thicken the oil
by ten powers of ten. Bulk modulus and air are not given by the paper: usual values.</p></html>"));
end ServoPumpOil;
