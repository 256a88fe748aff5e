within Mechanical.Rotational;
package Examples "A small circuit for each component"
end Examples;
