within Hydraulic;
package SealFriction "Friction of cylinder seals, interchangeable"
end SealFriction;
