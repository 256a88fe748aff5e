within Oil;
package Viscosity "Laws of dynamic viscosity over temperature, at low pressure"
end Viscosity;
