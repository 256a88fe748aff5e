within Hydraulic.EntrainedAir;
model Frozen "The undissolved share of the air is that of the circuit's oil and does not change"
  extends Law;
equation
  x = oil.x_u;
  (rho, beta,, s) = oil.density(p);
  rho_port = rho_s;
  port_density = 1;
  swell = 0;
  annotation(Documentation(info = "<html><p>For processes that are fast against dissolving, seconds to minutes. Source: S. Kim and H. Murrenhoff, J. Fluids Eng. 134 (2012) 021201.</p></html>"));
end Frozen;
