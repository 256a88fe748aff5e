within Oil;
package Thickening "Laws of viscosity over pressure"
end Thickening;
