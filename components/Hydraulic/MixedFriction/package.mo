within Hydraulic;
package MixedFriction "Share of fluid friction in a lubricated pair"
end MixedFriction;
