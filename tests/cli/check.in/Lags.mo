model Lags "Lags with their rates in an array"
  parameter Real k[3](each unit = "1/s") = {1, 2, 3};
  parameter Real gain = 1;
  Real x[3](each start = 1, each fixed = true);
equation
  for i in 1:3 loop
    der(x[i]) = -gain*k[i]*x[i];
  end for;
end Lags;
