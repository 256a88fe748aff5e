within Signal;
package Bases "Partial blocks"
end Bases;
