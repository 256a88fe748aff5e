within Effects;
package Interfaces "How effects attach to a network"
end Interfaces;
