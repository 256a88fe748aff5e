within Pneumatic;
package Functions "Laws of flow"
end Functions;
