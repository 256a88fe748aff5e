model Unknown
  Hydraulic.NoSuch x;
end Unknown;
