within Electrical;
package Bases "Partial models that components extend"
end Bases;
