within Hydraulic;
package Examples "A small circuit for each component"
end Examples;
