within Oil;
package Compression "Laws of density and bulk modulus over pressure"
end Compression;
