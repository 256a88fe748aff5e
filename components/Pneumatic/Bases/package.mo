within Pneumatic;
package Bases "What components share"
end Bases;
