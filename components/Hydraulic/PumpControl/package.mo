within Hydraulic;
package PumpControl "Hydraulic controls of variable pumps: they set the displacement by pressures"
end PumpControl;
