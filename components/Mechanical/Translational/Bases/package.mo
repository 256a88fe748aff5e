within Mechanical.Translational;
package Bases "Partial models that components extend"
end Bases;
