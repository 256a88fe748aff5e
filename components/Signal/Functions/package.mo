within Signal;
package Functions "Functions behind the blocks"
end Functions;
