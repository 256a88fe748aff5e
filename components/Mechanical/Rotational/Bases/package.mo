within Mechanical.Rotational;
package Bases "Partial models that components extend"
end Bases;
