within Pneumatic;
package Examples "A small circuit for each component"
end Examples;
