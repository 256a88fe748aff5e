within Modelica.Units;
package Conversions "Conversions between SI and other units"
  function to_degC "Kelvin to degree Celsius"
    input Modelica.Units.SI.Temperature u "Value in kelvin";
    output Modelica.Units.NonSI.Temperature_degC y "Value in degree Celsius";
  algorithm
    y := u - 273.15;
    annotation(Inline = true);
  end to_degC;
  function from_degC "Degree Celsius to kelvin"
    input Modelica.Units.NonSI.Temperature_degC u "Value in degree Celsius";
    output Modelica.Units.SI.Temperature y "Value in kelvin";
  algorithm
    y := u + 273.15;
    annotation(Inline = true);
  end from_degC;
  function to_deg "Radian to degree"
    input Modelica.Units.SI.Angle u "Value in radian";
    output Modelica.Units.NonSI.Angle_deg y "Value in degree";
  algorithm
    y := (180/Modelica.Constants.pi)*u;
    annotation(Inline = true);
  end to_deg;
  function from_deg "Degree to radian"
    input Modelica.Units.NonSI.Angle_deg u "Value in degree";
    output Modelica.Units.SI.Angle y "Value in radian";
  algorithm
    y := (Modelica.Constants.pi/180)*u;
    annotation(Inline = true);
  end from_deg;
  function to_rpm "Radian per second to revolutions per minute"
    input Modelica.Units.SI.AngularVelocity u "Value in radian per second";
    output Modelica.Units.NonSI.AngularVelocity_rpm y "Value in revolutions per minute";
  algorithm
    y := (30/Modelica.Constants.pi)*u;
    annotation(Inline = true);
  end to_rpm;
  function from_rpm "Revolutions per minute to radian per second"
    input Modelica.Units.NonSI.AngularVelocity_rpm u "Value in revolutions per minute";
    output Modelica.Units.SI.AngularVelocity y "Value in radian per second";
  algorithm
    y := (Modelica.Constants.pi/30)*u;
    annotation(Inline = true);
  end from_rpm;
  function to_kmh "Metre per second to kilometre per hour"
    input Modelica.Units.SI.Velocity u "Value in metre per second";
    output Modelica.Units.NonSI.Velocity_kmh y "Value in kilometre per hour";
  algorithm
    y := u*3.6;
    annotation(Inline = true);
  end to_kmh;
  function from_kmh "Kilometre per hour to metre per second"
    input Modelica.Units.NonSI.Velocity_kmh u "Value in kilometre per hour";
    output Modelica.Units.SI.Velocity y "Value in metre per second";
  algorithm
    y := u/3.6;
    annotation(Inline = true);
  end from_kmh;
  function to_day "Second to day"
    input Modelica.Units.SI.Time u "Value in second";
    output Modelica.Units.NonSI.Time_day y "Value in day";
  algorithm
    y := u/86400;
    annotation(Inline = true);
  end to_day;
  function from_day "Day to second"
    input Modelica.Units.NonSI.Time_day u "Value in day";
    output Modelica.Units.SI.Time y "Value in second";
  algorithm
    y := u*86400;
    annotation(Inline = true);
  end from_day;
  function to_hour "Second to hour"
    input Modelica.Units.SI.Time u "Value in second";
    output Modelica.Units.NonSI.Time_hour y "Value in hour";
  algorithm
    y := u/3600;
    annotation(Inline = true);
  end to_hour;
  function from_hour "Hour to second"
    input Modelica.Units.NonSI.Time_hour u "Value in hour";
    output Modelica.Units.SI.Time y "Value in second";
  algorithm
    y := u*3600;
    annotation(Inline = true);
  end from_hour;
  function to_minute "Second to minute"
    input Modelica.Units.SI.Time u "Value in second";
    output Modelica.Units.NonSI.Time_minute y "Value in minute";
  algorithm
    y := u/60;
    annotation(Inline = true);
  end to_minute;
  function from_minute "Minute to second"
    input Modelica.Units.NonSI.Time_minute u "Value in minute";
    output Modelica.Units.SI.Time y "Value in second";
  algorithm
    y := u*60;
    annotation(Inline = true);
  end from_minute;
  function to_litre "Cubic metre to litre"
    input Modelica.Units.SI.Volume u "Value in cubic metre";
    output Modelica.Units.NonSI.Volume_litre y "Value in litre";
  algorithm
    y := u*1e3;
    annotation(Inline = true);
  end to_litre;
  function from_litre "Litre to cubic metre"
    input Modelica.Units.NonSI.Volume_litre u "Value in litre";
    output Modelica.Units.SI.Volume y "Value in cubic metre";
  algorithm
    y := u*1e-3;
    annotation(Inline = true);
  end from_litre;
  function to_kWh "Joule to kilowatt hour"
    input Modelica.Units.SI.Energy u "Value in joule";
    output Modelica.Units.NonSI.Energy_kWh y "Value in kilowatt hour";
  algorithm
    y := u/3.6e6;
    annotation(Inline = true);
  end to_kWh;
  function from_kWh "Kilowatt hour to joule"
    input Modelica.Units.NonSI.Energy_kWh u "Value in kilowatt hour";
    output Modelica.Units.SI.Energy y "Value in joule";
  algorithm
    y := u*3.6e6;
    annotation(Inline = true);
  end from_kWh;
  function to_bar "Pascal to bar"
    input Modelica.Units.SI.Pressure u "Value in pascal";
    output Modelica.Units.NonSI.Pressure_bar y "Value in bar";
  algorithm
    y := u*1e-5;
    annotation(Inline = true);
  end to_bar;
  function from_bar "Bar to pascal"
    input Modelica.Units.NonSI.Pressure_bar u "Value in bar";
    output Modelica.Units.SI.Pressure y "Value in pascal";
  algorithm
    y := u*1e5;
    annotation(Inline = true);
  end from_bar;
  function to_gps "Kilogram per second to gram per second"
    input Modelica.Units.SI.MassFlowRate u "Value in kilogram per second";
    output Modelica.Units.NonSI.MassFlowRate_gps y "Value in gram per second";
  algorithm
    y := u*1e3;
    annotation(Inline = true);
  end to_gps;
  function from_gps "Gram per second to kilogram per second"
    input Modelica.Units.NonSI.MassFlowRate_gps u "Value in gram per second";
    output Modelica.Units.SI.MassFlowRate y "Value in kilogram per second";
  algorithm
    y := u*1e-3;
    annotation(Inline = true);
  end from_gps;
end Conversions;
