within Hydraulic;
package Functions "Laws of flow"
end Functions;
