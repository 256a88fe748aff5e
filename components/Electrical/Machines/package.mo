within Electrical;
package Machines "Electric motors"
end Machines;
