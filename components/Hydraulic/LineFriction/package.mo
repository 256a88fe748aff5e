within Hydraulic;
package LineFriction "Friction laws of lines"
end LineFriction;
