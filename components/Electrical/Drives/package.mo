within Electrical;
package Drives "Converters, controllers and encoders of electric drives"
end Drives;
