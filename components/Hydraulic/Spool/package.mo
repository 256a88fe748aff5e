within Hydraulic;
package Spool "Motion of valve spools, interchangeable"
end Spool;
